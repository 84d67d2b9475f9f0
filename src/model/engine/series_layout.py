"""Layout of series in memory, and the order in which they are computed.

Input: the ``Recurrences`` of a kind of mode (series.py). Output: a ``Layout``, which series_code.py
writes as code. Memory holds a line for each series that later orders need: the state, the event
quantities, sines and cosines, and factors of products and quotients. All other series stay in
registers.
"""

from collections.abc import Iterator
from copy import copy

from model.engine.series import LACK_OF_PRESS, STATES, EventQuantities, Recurrences
from model.engine.series_rules import (
    Convolved,
    Cosine,
    Lack,
    Product,
    Rate,
    Sine,
    StateVariable,
    SumSeries,
    TaylorSeries,
    product,
)

ORDER = 16  # of the series
METHOD = f"Taylor series of order {ORDER}"
# Orders of the linearised motion, by how far the fastest oscillation turns in a step (decision 3):
# on stiff bases it may be 3 radians.
ERROR_ORDERS = (5, 7, 9)
MOST_ERROR_ORDER = ERROR_ORDERS[-1]
REMAINDER = 2  # further orders, which estimate what the series omits
ORDERS = ORDER + REMAINDER + 1  # in memory
STATE_LINES = len(STATES)
TILT = 2  # line of the tilt
# Line of the sine of the tilt; its cosine, and sine and cosine of the excitation, follow.
SINES = STATE_LINES + len(EventQuantities._fields)
LACK = SINES + 4  # line of what the press falls short of f0, linear in time
_OTHERS = LACK + 1
LINES = _OTHERS + 16  # as many as the modes of plane parts on the edges need
FURTHER_LINES = 64  # of round parts, and of modes in the slot; they follow the last order
FRACTIONS = (0.25, 0.5, 0.75, 1.0)  # of a step, at which it is sampled
NODES = len(FRACTIONS) + 1
# Orders summed at these fractions: omitted terms are below 1e-4 of the last ones at the step's end.
SUMMED_ORDERS = (10, 13, ORDER, ORDER)


def _inputs(series: TaylorSeries) -> tuple[TaylorSeries, ...]:
    """Return the series whose coefficients of an order ``series`` needs for its own of it."""
    return series.inputs if isinstance(series, SumSeries | Rate | Convolved) else ()


class Layout:
    """Order in which the series of a kind of mode are computed, and their lines in memory.

    Series of positions alone are computed one order ahead of the others, which need their rates.

    Attributes:
        recurrences: the ``Recurrences``.
        terms: series in the sums of the accelerations.
        quantities: series of the event quantities.
        sines: sine and cosine of the tilt, and of the excitation's angle.
        prescribed: series of forces that depend on time alone.
        turning: products of the tilt rate with sine and cosine of the tilt.
        rate: rate of the excitation's angle.
        line: that of a series in memory; other series stay in registers.
        stage: number of products, quotients and roots to be computed one after another for a
            series.
        factors: see ``_choose_factors``.
    """

    def __init__(self, recurrences: Recurrences) -> None:
        self.recurrences = recurrences
        self.terms = [each for total in recurrences.accelerations for each in total.terms]
        self.quantities = [each.as_series() for each in recurrences.quantities]
        self.sines = self._sines()
        self.prescribed = (*self.sines[2:], LACK_OF_PRESS)
        self.line = {each: n for n, each in enumerate((*STATES, *self.quantities))}
        self.line |= {each: SINES + n for n, each in enumerate((*self.sines, LACK_OF_PRESS))}
        self.stage: dict[TaylorSeries, int] = {}
        for series in (*self.terms, *self.quantities):
            self._assign_stage(series)
        for series in self.stage:
            if isinstance(series, Convolved):
                for each in (*series.inputs, *(() if isinstance(series, Product) else (series,))):
                    self.line.setdefault(each, self._next_line())
            if not self.is_ahead(series):
                for each in filter(self.is_ahead, _inputs(series)):
                    self.line.setdefault(each, self._next_line())
        for each in filter(self.is_ahead, self.terms):
            self.line.setdefault(each, self._next_line())
        if self._next_line() > LINES + FURTHER_LINES:
            raise AssertionError(
                f"LINES = {LINES} and FURTHER_LINES = {FURTHER_LINES}: must be at least "
                f"{self._next_line()} together"
            )
        self.factors = self._choose_factors()

    def for_accelerations(self) -> "Layout":
        """Return the layout without series that only event quantities need; lines stay."""
        layout = copy(self)
        layout.stage = {}
        for each in self.terms:
            layout._assign_stage(each)
        return layout

    def _next_line(self) -> int:
        return max(self.line.values()) + 1

    def _sines(self) -> list[TaylorSeries]:
        """Return ``sines``; set ``turning`` and ``rate``."""
        tilt = (0.0, ((STATES[2], 1.0),))
        pair = Sine(*tilt), Cosine(*tilt)
        self.turning = [product(STATES[5], each) for each in pair]
        (sine,) = [each for each in self.terms if isinstance(each, Sine) and each != pair[0]]
        self.rate = sine.terms[0][1]  # of the excitation's angle
        return [*pair, sine, Cosine(sine.constant, sine.terms)]

    def _choose_factors(self) -> dict[TaylorSeries, tuple[TaylorSeries, TaylorSeries]]:
        """Choose the factors a and b of Σ_j a_j b_(k-j), for every product, quotient and root.

        Products share loads if they read the same line in the same direction: sines and cosines are
        read forward, as a. Of a quotient, a is the quotient itself and b its divisor.
        """
        taken: set[tuple[TaylorSeries, bool | None]] = set()  # None: forward

        def merit(forward: TaylorSeries, backward: TaylorSeries, ahead: bool) -> tuple[bool, int]:
            shared = ((forward, None) in taken) + ((backward, ahead) in taken)
            return isinstance(forward, Sine | Cosine), shared

        factors: dict[TaylorSeries, tuple[TaylorSeries, TaylorSeries]] = {}
        for series in dict.fromkeys((*self.products(True), *self.turning, *self.products(False))):
            ahead, (one, other) = self.is_ahead(series), series.factors
            if isinstance(series, Product) and merit(other, one, ahead) > merit(one, other, ahead):
                one, other = other, one
            taken |= {(one, None), (other, ahead)}
            factors[series] = one, other
        return factors

    def _assign_stage(self, series: TaylorSeries) -> int:
        if series not in self.stage:
            before = max((self._assign_stage(each) for each in _inputs(series)), default=0)
            self.stage[series] = before + isinstance(series, Convolved)
        return self.stage[series]

    def is_ahead(self, series: TaylorSeries) -> bool:
        """Return whether a series depends on positions alone."""
        if isinstance(series, StateVariable):
            return series.number < len(STATES) // 2
        if isinstance(series, Sine | Cosine):
            return series in self.sines[:2]
        return not isinstance(series, Rate | Lack) and all(map(self.is_ahead, _inputs(series)))

    def stages(self, ahead: bool) -> Iterator[tuple[list[Convolved], list[SumSeries | Rate]]]:
        """Yield for each stage its convolved series, and its other series in their order."""
        for stage in range(max(self.stage.values()) + 1):
            here = [each for each, its_stage in self.stage.items() if its_stage == stage]
            here = [each for each in here if self.is_ahead(each) == ahead]
            products = [each for each in here if isinstance(each, Convolved)]
            yield products, [each for each in here if isinstance(each, SumSeries | Rate)]

    def products(self, ahead: bool) -> list[Convolved]:
        """Return all products, quotients and roots, of positions alone or all others."""
        return [each for products, _ in self.stages(ahead) for each in products]
