"""Layout of series in memory, and the order in which their rows are computed.

Memory holds for every order the rows that later orders need: the state, the event quantities, the
sine and cosine rows, and factors of products and quotients. All other rows stay in registers.
"""

from collections.abc import Iterator
from copy import copy

from model.engines.batch.series import STATES, EventQuantities, Recurrences, TaylorSeries

ORDER = 16  # of the series
ERROR_ORDER = 8  # of the series of the linearised motion; a step may be 3 radians of a contact
REMAINDER = 1  # further orders, which estimate what the series omits
ORDERS = ORDER + REMAINDER + 1  # in memory
STATE_ROWS = len(STATES)
TILT = 2  # row of the tilt
SINES = STATE_ROWS + len(
    EventQuantities._fields
)  # sine and cosine of the tilt, and of the excitation
_OTHERS = SINES + 4
ROWS = _OTHERS + 16  # as many as the modes on the edges need
FURTHER_ROWS = 12  # of modes in the slot; they follow the last order
FRACTIONS = (0.25, 0.5, 0.75, 1.0)  # of a step, at which it is sampled
NODES = len(FRACTIONS) + 1
# Order of the last term summed at each fraction; omitted ones are below 1e-4 of those at the end.
ORDERS_THERE = (10, 13, ORDER, ORDER)


def _made_of(row: TaylorSeries) -> tuple[TaylorSeries, ...]:
    """Return the rows whose coefficients of the same order a coefficient of ``row`` needs."""
    if row.kind in ("product", "quotient", "rate"):
        return row.of
    if row.kind == "sum":
        return tuple(each for each, _ in row.of[1])
    return ()


class Plan:
    """Order in which the rows of a kind of mode are computed, and their places in memory.

    Rows of positions alone are computed one order ahead of the others, which need their rates.
    """

    def __init__(self, series: Recurrences) -> None:
        self.series = series
        self.watched = [each.as_row() for each in series.watched]
        self.sines = self._pairs()
        self.place = {row: n for n, row in enumerate((*STATES, *self.watched))}
        self.place |= {row: SINES + n for n, row in enumerate(self.sines)}
        self.stage: dict[TaylorSeries, int] = {}
        for total in self.series.accelerations:
            for row in total.terms:
                self._visit(row)
        for row in self.watched:
            self._visit(row)
        for row in self.stage:
            if row.kind in ("product", "quotient"):
                for each in (*row.of, *((row,) if row.kind == "quotient" else ())):
                    self.place.setdefault(each, self._next_place())
            if not self.is_ahead(row):
                for each in filter(self.is_ahead, _made_of(row)):
                    self.place.setdefault(each, self._next_place())
        if self._next_place() > ROWS + FURTHER_ROWS:
            raise AssertionError(
                f"ROWS = {ROWS} and FURTHER_ROWS = {FURTHER_ROWS}: must be at least "
                f"{self._next_place()} together"
            )
        self.factors = self._oriented()

    def of_accelerations(self) -> "Plan":
        """Return the plan without rows that only event quantities need; places stay."""
        plan = copy(self)
        plan.stage = {}
        for total in self.series.accelerations:
            for row in total.terms:
                plan._visit(row)
        return plan

    def _next_place(self) -> int:
        return max(self.place.values()) + 1

    def _pairs(self) -> list[TaylorSeries]:
        tilt = (0.0, ((STATES[2], 1.0),))
        pair = TaylorSeries("sine", tilt), TaylorSeries("cosine", tilt)
        self.turning = [
            TaylorSeries("product", tuple(sorted((STATES[5], each), key=repr))) for each in pair
        ]
        found = [row for total in self.series.accelerations for row in total.terms]
        (sine,) = [row for row in found if row.kind == "sine" and row != pair[0]]
        self.rate = sine.of[1][0][1]  # of the excitation's angle
        return [*pair, sine, TaylorSeries("cosine", sine.of)]

    def _oriented(self) -> dict[TaylorSeries, tuple[TaylorSeries, TaylorSeries]]:
        """Factors of all products and quotients: the one read forward, and the one read backward.

        They are chosen so that products share loads: sines and cosines are read forward; of a
        quotient, the quotient itself is read forward and its divisor backward.
        """
        taken: set[tuple[TaylorSeries, bool | None]] = set()  # None: forward
        factors = {}
        for row in dict.fromkeys((*self.products(True), *self.turning, *self.products(False))):
            ahead = self.is_ahead(row)
            choices = [row.of, row.of[::-1]] if row.kind == "product" else [(row, row.of[1])]
            forward, backward = max(
                choices,
                key=lambda each, ahead=ahead: (
                    each[0].kind in ("sine", "cosine"),
                    ((each[0], None) in taken) + ((each[1], ahead) in taken),
                ),
            )
            taken |= {(forward, None), (backward, ahead)}
            factors[row] = forward, backward
        return factors

    def _visit(self, row: TaylorSeries) -> int:
        if row not in self.stage:
            before = max((self._visit(each) for each in _made_of(row)), default=0)
            self.stage[row] = before + (row.kind in ("product", "quotient"))
        return self.stage[row]

    def is_ahead(self, row: TaylorSeries) -> bool:
        """Return whether a row depends on positions alone."""
        if row.kind == "state":
            return bool(row.of[0] < len(STATES) // 2)
        if row.kind in ("sine", "cosine"):
            return row in self.sines[:2]
        made = _made_of(row)
        return row.kind != "rate" and all(map(self.is_ahead, made))

    def stages(self, ahead: bool) -> Iterator[tuple[list[TaylorSeries], list[TaylorSeries]]]:
        """Yield for each stage its products and quotients, and its other rows in their order."""
        for stage in range(max(self.stage.values()) + 1):
            rows = [row for row, each in self.stage.items() if each == stage]
            rows = [row for row in rows if self.is_ahead(row) == ahead]
            products = [row for row in rows if row.kind in ("product", "quotient")]
            yield products, [row for row in rows if row.kind in ("sum", "rate")]

    def products(self, ahead: bool) -> list[TaylorSeries]:
        """Return all products and quotients, of positions alone or all others."""
        return [row for products, _ in self.stages(ahead) for row in products]
