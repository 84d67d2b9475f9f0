"""Machine code of series: from the state of runs in a kind of mode to their coefficients.

Input: the ``Layout`` of the kind (series_layout.py). Output: a ``VectorWriter`` with the code, of
which series_kernels.py makes kernels. The code computes WIDTH runs, one in each lane of a vector,
in the memory ``coefficients[order, line, lane]``.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from model.compile.vector_code import WIDTH, VectorWriter
from model.engine.series import STATES, Sum
from model.engine.series_layout import (
    FURTHER_LINES,
    LINES,
    ORDERS,
    TILT,
    Layout,
)
from model.engine.series_rules import (
    Constant,
    Convolved,
    Product,
    Quotient,
    Rate,
    Root,
    SumSeries,
    TaylorSeries,
    Terms,
)

_FIRST = "0"  # order


def _loops(several: list[TaylorSeries]) -> Iterator[list[TaylorSeries]]:
    """Yield the series that are summed in one loop: as many sums as stay in registers.

    AVX-512 has twice as many registers as others. With 14 sums in a loop, a page takes 1.15 times
    as long as with 5, and AVX2 1.08 times as long as with 10 (decision 61).
    """
    size = {8: 14, 4: 10}.get(WIDTH, 5)
    for first in range(0, len(several), size):
        yield several[first : first + size]


class SeriesWriter(VectorWriter):
    """Writes the function (coefficients, given, last) that fills coefficients of a kind of mode.

    ``coefficients`` are LINES vectors for each order, those of states and sines of the first order
    known, ``given`` GIVEN constants and signs, and ``last`` is the last order of the states.
    Coefficients in registers: ``ahead`` of series of positions alone, one order ahead, and
    ``value`` of all others; ``terms`` holds the sums of ``_sum_known``.
    """

    signature = "coefficients, given, last"

    def __init__(self, name: str, layout: Layout) -> None:
        super().__init__(name, self.signature.count(",") + 1)
        self.memory, self.given, *others = self.arguments
        self.other, self.last = others[0], others[-1]
        self.layout = layout
        self.known: dict[Constant, str] = {}
        totals = [
            Sum(series.constant, dict(series.terms))
            for series in layout.stage
            if isinstance(series, SumSeries)
        ]
        for total in (*totals, *layout.recurrences.accelerations):
            for each in (total.constant, *total.terms.values()):
                self.constant(each)
        self.constant(layout.rate)
        self.terms: dict[TaylorSeries, str] = {}
        self.ahead: dict[TaylorSeries, str] = {}
        self._write_stages(_FIRST, ahead=True)
        self._one_order(_FIRST)
        self.repeat(self._further_orders(), self._one_more)

    def _further_orders(self) -> str:
        """The number of orders, after the first, from which a next one is computed."""
        return self.count("sub", self.whole_number(self.last), "1")

    def constant(self, value: Constant) -> str:
        """A constant, computed before the first order."""
        if isinstance(value, float):
            return self.vector(value)
        if value not in self.known:
            kind, *of = value
            if kind == "given":
                self.known[value] = self.load(self.given, of[0])
            else:
                operation = {"+": "fadd", "*": "fmul", "/": "fdiv"}[kind]
                self.known[value] = self.do(operation, *map(self.constant, of))
        return self.known[value]

    def _line(self, memory: str, series: TaylorSeries, order: str) -> tuple[str, int]:
        """Return the address of an order's lines, and the line of ``series`` among them."""
        line, lines, first = self.layout.line[series], LINES, 0
        if line >= LINES:
            line, lines, first = line - LINES, FURTHER_LINES, ORDERS * LINES
        return self.base(memory, order, lines), first + line

    def _at(self, series: TaylorSeries, order: str) -> str:
        return self.load(*self._line(self.memory, series, order))

    def _keep(self, value: str, series: TaylorSeries, order: str) -> None:
        self.store(value, *self._line(self.memory, series, order))

    def _one_more(self, index: str) -> tuple[()]:
        order = self.count("add", index, "1")
        self._sum_known(order)
        self._one_order(order)
        return ()

    def _one_order(self, order: str) -> None:
        """Compute every series at ``order``, then states, sines and cosines at the next order."""
        layout, half = self.layout, len(STATES) // 2
        following = self.count("add", order, "1")
        self.number = self.everywhere(following)
        per_order = self.do("fdiv", self.vector(1.0), self.number)
        self.value = {series: self._at(series, order) for series in STATES[half:]}
        for n in range(half):
            position = self.do("fmul", self.value[STATES[half + n]], per_order)
            self._keep(position, STATES[n], following)
        self._begin_next(order, following, per_order)
        self.ahead = {}
        self._write_stages(following, ahead=True)
        self._write_stages(order, ahead=False)
        for n, total in enumerate(layout.recurrences.accelerations):
            rate = self._total(total.constant, tuple(total.terms.items()), order, self.value)
            self._keep(self.do("fmul", rate, per_order), STATES[half + n], following)

    def _begin_next(self, order: str, following: str, per_order: str) -> None:
        """Compute the sines and cosines at ``following`` from the series at ``order``."""
        layout = self.layout
        self.value |= {series: self._at(series, order) for series in layout.sines[2:]}
        self._complete(layout.turning, order, self.value)
        sine, cosine, swing, other = layout.sines
        turns, turned = (self.value[series] for series in layout.turning)
        self._keep(self.do("fmul", turned, per_order), sine, following)
        self._keep(self.do("fmul", turns, self.do("fneg", per_order)), cosine, following)
        rate = self.do("fmul", self.constant(layout.rate), per_order)
        self._keep(self.do("fmul", rate, self.value[other]), swing, following)
        self._keep(self.do("fmul", self.do("fneg", rate), self.value[swing]), other, following)

    def _write_stages(self, order: str, ahead: bool) -> None:
        """Compute at ``order`` the series of positions alone (``ahead``), or all others."""
        layout = self.layout
        values = self.ahead if ahead else self.value
        for products, others in layout.stages(ahead):
            self._complete(products, order, values)
            for series in others:
                if isinstance(series, Rate):
                    values[series] = self.do("fmul", self.ahead[series.of], self.number)
                else:
                    values[series] = self._total(series.constant, series.terms, order, values)
                if series in layout.line:
                    self._keep(values[series], series, order)

    def _total(
        self,
        constant: Constant,
        terms: Terms,
        order: str,
        values: dict[TaylorSeries, str],
    ) -> str:
        """Sum a constant and multiples of series, which are in ``values`` or in memory."""
        total = self.constant(constant) if order == _FIRST and constant != 0.0 else None
        for series, factor in terms:
            term = self.constant(factor), self._newest(series, order, values)
            total = self.do("fmul", *term) if total is None else self.fma(*term, total)
        return self.vector(0.0) if total is None else total

    def _newest(self, series: TaylorSeries, order: str, values: dict[TaylorSeries, str]) -> str:
        """The coefficient of a series at ``order``, from ``values`` or from memory."""
        if series not in values:
            values[series] = self._at(series, order)
        return values[series]

    def _sum_known(self, order: str) -> None:
        """Sum the terms of all products whose factors are known before ``order`` k.

        They are Σ_j a_j b_(k-j) over 0 < j < k; for products that are ahead, Σ_j a_j b_(k+1-j) over
        0 < j <= k. One loop computes many sums, since none waits for another.
        """
        layout, several = self.layout, list(self.layout.factors)
        before, body, after = self.block, self.name("known"), self.name("all_known")
        is_later = self.count("icmp sgt", order, "1")
        self.lines.append(f"br i1 {is_later}, label %{body}, label %{after}")
        self.begin(body)
        sums: list[str] = []
        for some in _loops(several):
            sums += self._sum_some(some, order)
        body = self.block
        self.lines.append(f"br label %{after}")
        self.begin(after)
        for series, value in zip(several, sums, strict=True):
            self.terms[series] = self.merged((before, self.vector(0.0)), (body, value))
        for series in filter(layout.is_ahead, several):
            forward, backward = layout.factors[series]
            last = self._at(forward, order), self._at(backward, "1")
            self.terms[series] = self.fma(*last, self.terms[series])

    def _sum_some(self, several: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j a_j b_(k-j) over 0 < j < ``order``."""

        def add_terms(index: str, *sums: str) -> list[str]:
            j = self.count("add", index, "1")
            opposite = self.count("sub", order, j), self.count("sub", order, index)
            added = []
            for series, total in zip(several, sums, strict=True):
                forward, backward = self.layout.factors[series]
                factors = (
                    self._at(forward, j),
                    self._at(backward, opposite[self.layout.is_ahead(series)]),
                )
                added.append(self.fma(*factors, total))
            return added

        count = self.count("sub", order, "1")
        return self.repeat(count, add_terms, *(self.vector(0.0) for _ in several))

    def _complete(
        self, products: Sequence[Convolved], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Complete the products of a stage at ``order`` by the terms with their newest factors."""
        for series in products:
            one, other = series.factors
            total = self.terms.get(series, self.vector(0.0))
            if isinstance(series, Product):
                total = self.fma(self._newest(one, order, values), self._at(other, _FIRST), total)
            if order != _FIRST and not isinstance(series, Root):
                total = self.fma(self._at(one, _FIRST), self._newest(other, order, values), total)
            if not isinstance(series, Product):
                total = self._finished(series, total, order)
            values[series] = total
            if series in self.layout.line:
                self._keep(values[series], series, order)

    def _finished(self, series: Quotient | Root, others: str, order: str) -> str:
        """q_k = (a_k - Σ_(j<k) q_j b_(k-j)) / b_0; r_k = (a_k - Σ_(0<j<k) r_j r_(k-j)) / 2 r_0."""
        of = self._at(series.of, order)
        if isinstance(series, Root) and order == _FIRST:
            return self.call("sqrt", of)
        return self._divided(series, self.do("fsub", of, others), self._at)

    def _divided(
        self, series: Quotient | Root, rest: str, at: Callable[[TaylorSeries, str], str]
    ) -> str:
        """Divide by b_0 of a quotient, or 2 r_0 of a root."""
        if isinstance(series, Root):
            first = at(series, _FIRST)
            return self.do("fdiv", rest, self.do("fadd", first, first))
        return self.do("fdiv", rest, at(series.by, _FIRST))


class ErrorWriter(SeriesWriter):
    """Writes the function (errors, given, coefficients, last): series of the linearised motion.

    ``errors`` has the layout of ``coefficients``, which are filled already. The errors of the
    states are given at order 0; errors of their coefficients are filled in up to ``last``.
    """

    signature = "errors, given, coefficients, last"

    def __init__(self, name: str, layout: Layout) -> None:
        super().__init__(name, layout.for_accelerations())

    def _begin_next(self, order: str, *_: str) -> None:
        """Add the terms with the errors at ``order`` to all series that are ahead of it."""
        for series in filter(self.layout.is_ahead, self._with_pairs()):
            total = self.terms.get(series, self.vector(0.0))
            for one, other in self._pairs(series):
                total = self.fma(self._at(one, order), self._coefficient(other, "1"), total)
            self.terms[series] = total

    def _with_pairs(self) -> list[TaylorSeries]:
        """All series with pairs."""
        return [*self.layout.sines[:2], *self.layout.products(True), *self.layout.products(False)]

    def _write_stages(self, order: str, ahead: bool) -> None:
        if ahead:
            self._complete(self.layout.sines[:2], order, self.ahead)
        super()._write_stages(order, ahead)

    def _total(self, _: Constant, terms: Terms, *at: Any) -> str:
        """The error of a sum; excitation and press have none."""
        prescribed = self.layout.prescribed
        return super()._total(0.0, tuple(each for each in terms if each[0] not in prescribed), *at)

    def _pairs(self, series: TaylorSeries) -> tuple[tuple[TaylorSeries, TaylorSeries], ...]:
        """Pairs (a, b): Σ_j (error of a)_j b_(k-j), summed over them, is the error of a series."""
        if isinstance(series, Convolved):
            return series.factors, series.factors[::-1]
        sine, cosine = self.layout.sines[:2]
        return ((STATES[TILT], cosine if series == sine else sine),)

    def _coefficient(self, series: TaylorSeries, order: str) -> str:
        return self.load(*self._line(self.other, series, order))

    def _sum_known(self, order: str) -> None:
        """Sum the terms of all pairs with errors of orders below ``order``."""
        several = self._with_pairs()
        for some in _loops(several):
            self.terms |= zip(some, self._sum_some(some, order), strict=True)

    def _sum_some(self, several: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j (error of a)_j b_(k-j) over j < ``order``, of all pairs of each series."""

        def add_terms(j: str, *sums: str) -> list[str]:
            behind = self.count("sub", order, j)
            opposite = behind, self.count("add", behind, "1")
            added = []
            for series, total in zip(several, sums, strict=True):
                at = opposite[self.layout.is_ahead(series)]
                for one, other in self._pairs(series):
                    total = self.fma(self._at(one, j), self._coefficient(other, at), total)
                added.append(total)
            return added

        return self.repeat(order, add_terms, *(self.vector(0.0) for _ in several))

    def _complete(
        self, several: Sequence[TaylorSeries], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Complete the errors of series at ``order`` by the terms with the newest errors."""
        for series in several:
            total = self.terms.get(series, self.vector(0.0))
            for one, other in self._pairs(series):
                if one != series:
                    newest = self._newest(one, order, values)
                    total = self.fma(newest, self._coefficient(other, _FIRST), total)
            if isinstance(series, Quotient | Root):
                rest = self.do("fsub", self._newest(series.of, order, values), total)
                total = self._divided(series, rest, self._coefficient)
            values[series] = self.do("fneg", total) if series == self.layout.sines[1] else total
            if series in self.layout.line:
                self._keep(values[series], series, order)
