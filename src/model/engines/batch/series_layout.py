"""Layout of series in memory, and the order in which their rows are computed.

Input: the ``Recurrences`` of a kind of mode (series.py). Output: a ``Layout``, which series_code.py
writes as code. Memory holds for every order the rows that later orders need: the state, the event
quantities, the sine and cosine rows, and factors of products and quotients. All other rows stay in
registers.
"""

from collections.abc import Iterator
from copy import copy

from model.engines.batch.series import STATES, EventQuantities, Recurrences, TaylorSeries

ORDER = 16  # of the series
# Order of the linearised motion; lower ones fail on stiff bases (decision 3), where a step may last
# 3 radians of a contact's oscillation.
ERROR_ORDER = 8
REMAINDER = 1  # further orders, which estimate what the series omits
ORDERS = ORDER + REMAINDER + 1  # in memory
STATE_ROWS = len(STATES)
TILT = 2  # row of the tilt
SINES = STATE_ROWS + len(
    EventQuantities._fields
)  # row of the sine of the tilt; its cosine, and sine and cosine of the excitation, follow
_OTHERS = SINES + 4
ROWS = _OTHERS + 16  # as many as the modes on the edges need
FURTHER_ROWS = 12  # of modes in the slot; they follow the last order
FRACTIONS = (0.25, 0.5, 0.75, 1.0)  # of a step, at which it is sampled
NODES = len(FRACTIONS) + 1
# Orders summed at these fractions: omitted terms are below 1e-4 of the last ones at the step's end.
SUMMED_ORDERS = (10, 13, ORDER, ORDER)


def _inputs(row: TaylorSeries) -> tuple[TaylorSeries, ...]:
    """Return the rows whose coefficients of an order ``row`` needs for its own of that order."""
    if row.rule in ("product", "quotient", "rate"):
        return row.operands
    if row.rule == "sum":
        return tuple(each for each, _ in row.operands[1])
    return ()


class Layout:
    """Order in which the rows of a kind of mode are computed, and their places in memory.

    Rows of positions alone are computed one order ahead of the others, which need their rates.

    Attributes:
        series: the ``Recurrences``.
        terms: rows in the sums of the accelerations.
        quantities: rows of the event quantities.
        sines: sine and cosine of the tilt, and of the excitation's angle.
        turning: products of the tilt rate with sine and cosine of the tilt.
        rate: rate of the excitation's angle.
        place: place of a row in memory, in rows; other rows stay in registers.
        stage: number of products and quotients to be computed one after another for a row.
        factors: see ``_choose_factors``.
    """

    def __init__(self, series: Recurrences) -> None:
        self.series = series
        self.terms = [row for total in series.accelerations for row in total.terms]
        self.quantities = [each.as_row() for each in series.quantities]
        self.sines = self._sine_rows()
        self.place = {row: n for n, row in enumerate((*STATES, *self.quantities))}
        self.place |= {row: SINES + n for n, row in enumerate(self.sines)}
        self.stage: dict[TaylorSeries, int] = {}
        for row in (*self.terms, *self.quantities):
            self._assign_stage(row)
        for row in self.stage:
            if row.rule in ("product", "quotient"):
                for each in (*row.operands, *((row,) if row.rule == "quotient" else ())):
                    self.place.setdefault(each, self._next_place())
            if not self.is_ahead(row):
                for each in filter(self.is_ahead, _inputs(row)):
                    self.place.setdefault(each, self._next_place())
        for each in filter(self.is_ahead, self.terms):
            self.place.setdefault(each, self._next_place())
        if self._next_place() > ROWS + FURTHER_ROWS:
            raise AssertionError(
                f"ROWS = {ROWS} and FURTHER_ROWS = {FURTHER_ROWS}: must be at least "
                f"{self._next_place()} together"
            )
        self.factors = self._choose_factors()

    def for_accelerations(self) -> "Layout":
        """Return the layout without rows that only event quantities need; places stay."""
        layout = copy(self)
        layout.stage = {}
        for row in self.terms:
            layout._assign_stage(row)
        return layout

    def _next_place(self) -> int:
        return max(self.place.values()) + 1

    def _sine_rows(self) -> list[TaylorSeries]:
        """Return ``sines``; set ``turning`` and ``rate``."""
        tilt = (0.0, ((STATES[2], 1.0),))
        pair = TaylorSeries("sine", tilt), TaylorSeries("cosine", tilt)
        self.turning = [
            TaylorSeries("product", tuple(sorted((STATES[5], each), key=repr))) for each in pair
        ]
        (sine,) = [row for row in self.terms if row.rule == "sine" and row != pair[0]]
        self.rate = sine.operands[1][0][1]  # of the excitation's angle
        return [*pair, sine, TaylorSeries("cosine", sine.operands)]

    def _choose_factors(self) -> dict[TaylorSeries, tuple[TaylorSeries, TaylorSeries]]:
        """Choose the factors a and b of Σ_j a_j b_(k-j), for every product and quotient.

        Products share loads if they read the same row in the same direction: sines and cosines are
        read forward, as a. Of a quotient, a is the quotient itself and b its divisor.
        """
        taken: set[tuple[TaylorSeries, bool | None]] = set()  # None: forward

        def merit(forward: TaylorSeries, backward: TaylorSeries, ahead: bool) -> tuple[bool, int]:
            shared = ((forward, None) in taken) + ((backward, ahead) in taken)
            return forward.rule in ("sine", "cosine"), shared

        factors = {}
        for row in dict.fromkeys((*self.products(True), *self.turning, *self.products(False))):
            ahead, (one, other) = self.is_ahead(row), row.factors
            if row.rule == "product" and merit(other, one, ahead) > merit(one, other, ahead):
                one, other = other, one
            taken |= {(one, None), (other, ahead)}
            factors[row] = one, other
        return factors

    def _assign_stage(self, row: TaylorSeries) -> int:
        if row not in self.stage:
            before = max((self._assign_stage(each) for each in _inputs(row)), default=0)
            self.stage[row] = before + (row.rule in ("product", "quotient"))
        return self.stage[row]

    def is_ahead(self, row: TaylorSeries) -> bool:
        """Return whether a row depends on positions alone."""
        if row.rule == "state":
            return bool(row.operands[0] < len(STATES) // 2)
        if row.rule in ("sine", "cosine"):
            return row in self.sines[:2]
        made = _inputs(row)
        return row.rule != "rate" and all(map(self.is_ahead, made))

    def stages(self, ahead: bool) -> Iterator[tuple[list[TaylorSeries], list[TaylorSeries]]]:
        """Yield for each stage its products and quotients, and its other rows in their order."""
        for stage in range(max(self.stage.values()) + 1):
            rows = [row for row, each in self.stage.items() if each == stage]
            rows = [row for row in rows if self.is_ahead(row) == ahead]
            products = [row for row in rows if row.rule in ("product", "quotient")]
            yield products, [row for row in rows if row.rule in ("sum", "rate")]

    def products(self, ahead: bool) -> list[TaylorSeries]:
        """Return all products and quotients, of positions alone or all others."""
        return [row for products, _ in self.stages(ahead) for row in products]
