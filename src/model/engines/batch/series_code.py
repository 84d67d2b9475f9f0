"""Machine code of series: from the state of runs in a kind of mode to their coefficients.

Input: the ``Layout`` of the kind (series_layout.py). Output: a ``VectorWriter`` with the code, of
which series_kernels.py makes kernels. The code computes WIDTH runs, one in each lane of a vector,
in the memory ``coefficients[order, row, lane]``.
"""

from typing import Any

from model.compile.vector_code import VectorWriter
from model.engines.batch.series import STATES, Constant, Sum, TaylorSeries
from model.engines.batch.series_layout import ERROR_ORDER, FURTHER_ROWS, ORDERS, ROWS, TILT, Layout

_FIRST = "0"  # order
_SUMS_PER_LOOP = 14  # sums in a loop


class SeriesWriter(VectorWriter):
    """Writes the function (coefficients, given, last) that fills coefficients of a kind of mode.

    ``coefficients`` are ROWS vectors for each order, the states and sines of the first order given,
    ``given`` GIVEN constants and signs, and ``last`` is the last order of the states. Coefficients
    in registers: ``ahead`` of rows of positions alone, one order ahead, and ``value`` of all
    others; ``terms`` holds the sums of ``_sum_known``.
    """

    places = "coefficients, given, last"

    def __init__(self, name: str, layout: Layout) -> None:
        super().__init__(name, 3)
        self.memory, self.given, self.other = self.arguments
        self.layout = layout
        self.known: dict[Constant, str] = {}
        totals = [
            Sum(row.operands[0], dict(row.operands[1])) for row in layout.stage if row.rule == "sum"
        ]
        for total in (*totals, *layout.series.accelerations):
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
        return self.count("sub", self.whole_number(self.other), "1")

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

    def _place(self, memory: str, row: TaylorSeries, order: str) -> tuple[str, int]:
        """Return the address of an order's rows, and the place of ``row`` among them."""
        place, rows, first = self.layout.place[row], ROWS, 0
        if place >= ROWS:
            place, rows, first = place - ROWS, FURTHER_ROWS, ORDERS * ROWS
        return self.base(memory, order, rows), first + place

    def _at(self, row: TaylorSeries, order: str) -> str:
        return self.load(*self._place(self.memory, row, order))

    def _keep(self, value: str, row: TaylorSeries, order: str) -> None:
        self.store(value, *self._place(self.memory, row, order))

    def _one_more(self, index: str) -> tuple[()]:
        order = self.count("add", index, "1")
        self._sum_known(order)
        self._one_order(order)
        return ()

    def _one_order(self, order: str) -> None:
        """Compute every row at ``order``, then states, sines and cosines at the next order."""
        layout, half = self.layout, len(STATES) // 2
        following = self.count("add", order, "1")
        self.number = self.everywhere(following)
        per_order = self.do("fdiv", self.vector(1.0), self.number)
        self.value = {row: self._at(row, order) for row in STATES[half:]}
        for n in range(half):
            position = self.do("fmul", self.value[STATES[half + n]], per_order)
            self._keep(position, STATES[n], following)
        self._begin_next(order, following, per_order)
        self.ahead = {}
        self._write_stages(following, ahead=True)
        self._write_stages(order, ahead=False)
        for n, total in enumerate(layout.series.accelerations):
            rate = self._total(total.constant, tuple(total.terms.items()), order, self.value)
            self._keep(self.do("fmul", rate, per_order), STATES[half + n], following)

    def _begin_next(self, order: str, following: str, per_order: str) -> None:
        """Compute the sines and cosines at ``following`` from the rows at ``order``."""
        layout = self.layout
        self.value |= {row: self._at(row, order) for row in layout.sines[2:]}
        self._complete(layout.turning, order, self.value)
        sine, cosine, swing, other = layout.sines
        turns, turned = (self.value[row] for row in layout.turning)
        self._keep(self.do("fmul", turned, per_order), sine, following)
        self._keep(self.do("fmul", turns, self.do("fneg", per_order)), cosine, following)
        rate = self.do("fmul", self.constant(layout.rate), per_order)
        self._keep(self.do("fmul", rate, self.value[other]), swing, following)
        self._keep(self.do("fmul", self.do("fneg", rate), self.value[swing]), other, following)

    def _write_stages(self, order: str, ahead: bool) -> None:
        """Compute at ``order`` the rows of positions alone (``ahead``), or all others."""
        layout = self.layout
        values = self.ahead if ahead else self.value
        for products, others in layout.stages(ahead):
            self._complete(products, order, values)
            for row in others:
                if row.rule == "rate":
                    values[row] = self.do("fmul", self.ahead[row.operands[0]], self.number)
                else:
                    values[row] = self._total(row.operands[0], row.operands[1], order, values)
                if row in layout.place:
                    self._keep(values[row], row, order)

    def _total(
        self,
        constant: Constant,
        terms: tuple[tuple[TaylorSeries, Constant], ...],
        order: str,
        values: dict[TaylorSeries, str],
    ) -> str:
        """Sum a constant and multiples of rows, which are in ``values`` or in memory."""
        total = self.constant(constant) if order == _FIRST and constant != 0.0 else None
        for row, factor in terms:
            term = self.constant(factor), self._newest(row, order, values)
            total = self.do("fmul", *term) if total is None else self.fma(*term, total)
        return self.vector(0.0) if total is None else total

    def _newest(self, row: TaylorSeries, order: str, values: dict[TaylorSeries, str]) -> str:
        """The coefficient of a row at ``order``, from ``values`` or from memory."""
        if row not in values:
            values[row] = self._at(row, order)
        return values[row]

    def _sum_known(self, order: str) -> None:
        """Sum the terms of all products whose factors are known before ``order`` k.

        They are Σ_j a_j b_(k-j) over 0 < j < k; for products that are ahead, Σ_j a_j b_(k+1-j) over
        0 < j <= k. One loop computes many sums, since none waits for another.
        """
        layout, rows = self.layout, list(self.layout.factors)
        before, body, after = self.block, self.name("known"), self.name("all_known")
        several = self.count("icmp sgt", order, "1")
        self.lines.append(f"br i1 {several}, label %{body}, label %{after}")
        self.begin(body)
        sums: list[str] = []
        for first in range(0, len(rows), _SUMS_PER_LOOP):
            sums += self._sum_some(rows[first : first + _SUMS_PER_LOOP], order)
        body = self.block
        self.lines.append(f"br label %{after}")
        self.begin(after)
        for row, value in zip(rows, sums, strict=True):
            self.terms[row] = self.merged((before, self.vector(0.0)), (body, value))
        for row in filter(layout.is_ahead, rows):
            forward, backward = layout.factors[row]
            last = self._at(forward, order), self._at(backward, "1")
            self.terms[row] = self.fma(*last, self.terms[row])

    def _sum_some(self, rows: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j a_j b_(k-j) over 0 < j < ``order``."""

        def add_terms(index: str, *sums: str) -> list[str]:
            j = self.count("add", index, "1")
            opposite = self.count("sub", order, j), self.count("sub", order, index)
            added = []
            for row, total in zip(rows, sums, strict=True):
                forward, backward = self.layout.factors[row]
                factors = (
                    self._at(forward, j),
                    self._at(backward, opposite[self.layout.is_ahead(row)]),
                )
                added.append(self.fma(*factors, total))
            return added

        count = self.count("sub", order, "1")
        return self.repeat(count, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(
        self, products: list[TaylorSeries], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Complete the products of a stage at ``order`` by the terms with their newest factors."""
        for row in products:
            one, other = row.factors
            total = self.terms.get(row, self.vector(0.0))
            if row.rule == "product":
                total = self.fma(self._newest(one, order, values), self._at(other, _FIRST), total)
            if order != _FIRST:
                total = self.fma(self._at(one, _FIRST), self._newest(other, order, values), total)
            values[row] = self._finished(row, total, order) if row.rule == "quotient" else total
            if row in self.layout.place:
                self._keep(values[row], row, order)

    def _finished(self, quotient: TaylorSeries, others: str, order: str) -> str:
        """q_k = (a_k - Σ_(j<k) q_j b_(k-j)) / b_0."""
        top, bottom = quotient.operands
        rest = self.do("fsub", self._at(top, order), others)
        return self.do("fdiv", rest, self._at(bottom, _FIRST))


class ErrorWriter(SeriesWriter):
    """Writes the function (errors, given, coefficients): the series of the linearised motion.

    ``errors`` has the layout of ``coefficients``, which are filled already. The errors of the
    states are given at order 0; errors of their coefficients are filled in up to ERROR_ORDER.
    """

    places = "errors, given, coefficients"

    def __init__(self, name: str, layout: Layout) -> None:
        super().__init__(name, layout.for_accelerations())

    def _further_orders(self) -> str:
        return str(ERROR_ORDER - 1)

    def _begin_next(self, order: str, *_: str) -> None:
        """Add the terms with the errors at ``order`` to all rows that are ahead of it."""
        for row in filter(self.layout.is_ahead, self._rows()):
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                total = self.fma(self._at(one, order), self._coefficient(other, "1"), total)
            self.terms[row] = total

    def _rows(self) -> list[TaylorSeries]:
        """All rows with pairs."""
        return [*self.layout.sines[:2], *self.layout.products(True), *self.layout.products(False)]

    def _write_stages(self, order: str, ahead: bool) -> None:
        if ahead:
            self._complete(self.layout.sines[:2], order, self.ahead)
        super()._write_stages(order, ahead)

    def _total(
        self, _: Constant, terms: tuple[tuple[TaylorSeries, Constant], ...], *at: Any
    ) -> str:
        """The error of a sum; the excitation has none."""
        excitation = self.layout.sines[2:]
        return super()._total(0.0, tuple(each for each in terms if each[0] not in excitation), *at)

    def _pairs(self, row: TaylorSeries) -> tuple[tuple[TaylorSeries, TaylorSeries], ...]:
        """Pairs (a, b): Σ_j (error of a)_j b_(k-j), summed over them, is the error of ``row``."""
        sine, cosine = self.layout.sines[:2]
        if row in (sine, cosine):
            return ((STATES[TILT], cosine if row == sine else sine),)
        return row.factors, row.factors[::-1]

    def _coefficient(self, row: TaylorSeries, order: str) -> str:
        return self.load(*self._place(self.other, row, order))

    def _sum_known(self, order: str) -> None:
        """Sum the terms of all pairs with errors of orders below ``order``."""
        rows = self._rows()
        for first in range(0, len(rows), _SUMS_PER_LOOP):
            some = rows[first : first + _SUMS_PER_LOOP]
            self.terms |= zip(some, self._sum_some(some, order), strict=True)

    def _sum_some(self, rows: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j (error of a)_j b_(k-j) over j < ``order``, of all pairs of each row."""

        def add_terms(j: str, *sums: str) -> list[str]:
            behind = self.count("sub", order, j)
            opposite = behind, self.count("add", behind, "1")
            added = []
            for row, total in zip(rows, sums, strict=True):
                at = opposite[self.layout.is_ahead(row)]
                for one, other in self._pairs(row):
                    total = self.fma(self._at(one, j), self._coefficient(other, at), total)
                added.append(total)
            return added

        return self.repeat(order, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(
        self, rows: list[TaylorSeries], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Complete the errors of rows at ``order`` by the terms with the newest errors."""
        for row in rows:
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                if one != row:
                    newest = self._newest(one, order, values)
                    total = self.fma(newest, self._coefficient(other, _FIRST), total)
            if row.rule == "quotient":
                top, bottom = row.operands
                rest = self.do("fsub", self._newest(top, order, values), total)
                total = self.do("fdiv", rest, self._coefficient(bottom, _FIRST))
            values[row] = self.do("fneg", total) if row == self.layout.sines[1] else total
            if row in self.layout.place:
                self._keep(values[row], row, order)
