"""Machine code of series: from the state of runs in a kind of mode to their coefficients.

The code is written for WIDTH runs, one in each lane of a vector, with the memory of series_plan.py:
``coefficients[order, row, lane]``.
"""

from typing import Any

from model.compile.vector_code import VectorWriter
from model.engines.batch.series import STATES, Constant, Sum, TaylorSeries
from model.engines.batch.series_plan import (
    ERROR_ORDER,
    FURTHER_ROWS,
    ORDERS,
    ROWS,
    TILT,
    Plan,
)

_FIRST = "0"  # order
_AT_ONCE = 14  # sums in a loop


class SeriesWriter(VectorWriter):
    """Writes the function (coefficients, given, last) that fills coefficients of a kind of mode.

    ``last`` holds the last order of the states.
    """

    def __init__(self, name: str, plan: Plan) -> None:
        super().__init__(name, 3)
        self.memory, self.given, self.other = self.arguments
        self.plan = plan
        self.known: dict[Constant, str] = {}
        totals = [Sum(row.of[0], dict(row.of[1])) for row in plan.stage if row.kind == "sum"]
        for total in (*totals, *plan.series.accelerations):
            for each in (total.constant, *total.terms.values()):
                self.constant(each)
        self.constant(plan.rate)
        self.terms: dict[TaylorSeries, str] = {}
        self.ahead: dict[TaylorSeries, str] = {}
        self._write_stages(_FIRST, ahead=True)
        self._one_order(_FIRST)
        self.repeat(self._further_orders(), self._one_more)

    def _further_orders(self) -> str:
        """The number of orders behind the first from which the next one is computed."""
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
        """Return the address of an order's rows, and the place of a row from there on."""
        place, rows, first = self.plan.place[row], ROWS, 0
        if place >= ROWS:
            place, rows, first = place - ROWS, FURTHER_ROWS, ORDERS * ROWS
        return self.base(memory, order, rows), first + place

    def _at(self, row: TaylorSeries, order: str) -> str:
        return self.load(*self._place(self.memory, row, order))

    def _keep(self, value: str, row: TaylorSeries, order: str) -> None:
        self.keep(value, *self._place(self.memory, row, order))

    def _one_more(self, index: str) -> tuple[()]:
        order = self.count("add", index, "1")
        self._sum_known(order)
        self._one_order(order)
        return ()

    def _one_order(self, order: str) -> None:
        """Every row at ``order``, and from that the states, sines and cosines at the next."""
        plan, half = self.plan, len(STATES) // 2
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
        for n, total in enumerate(plan.series.accelerations):
            rate = self._total(total.constant, tuple(total.terms.items()), order, self.value)
            self._keep(self.do("fmul", rate, per_order), STATES[half + n], following)

    def _begin_next(self, order: str, following: str, per_order: str) -> None:
        """The sines and cosines at ``following``, from the rows at ``order``."""
        plan = self.plan
        self.value |= {row: self._at(row, order) for row in plan.sines[2:]}
        self._complete(plan.turning, order, self.value)
        sine, cosine, swing, other = plan.sines
        turns, turned = (self.value[row] for row in plan.turning)
        self._keep(self.do("fmul", turned, per_order), sine, following)
        self._keep(self.do("fmul", turns, self.do("fneg", per_order)), cosine, following)
        rate = self.do("fmul", self.constant(plan.rate), per_order)
        self._keep(self.do("fmul", rate, self.value[other]), swing, following)
        self._keep(self.do("fmul", self.do("fneg", rate), self.value[swing]), other, following)

    def _write_stages(self, order: str, ahead: bool) -> None:
        """All rows that are made of positions alone, or all others, at ``order``."""
        plan = self.plan
        values = self.ahead if ahead else self.value
        for products, others in plan.stages(ahead):
            self._complete(products, order, values)
            for row in others:
                if row.kind == "rate":
                    values[row] = self.do("fmul", self.ahead[row.of[0]], self.number)
                else:
                    values[row] = self._total(row.of[0], row.of[1], order, values)
                if row in plan.place:
                    self._keep(values[row], row, order)

    def _total(
        self,
        constant: Constant,
        terms: tuple[tuple[TaylorSeries, Constant], ...],
        order: str,
        values: dict[TaylorSeries, str],
    ) -> str:
        """A constant and multiples of rows; those that ``values`` lacks are in memory."""
        total = self.constant(constant) if order == _FIRST and constant != 0.0 else None
        for row, factor in terms:
            term = self.constant(factor), self._newest(row, order, values)
            total = self.do("fmul", *term) if total is None else self.fma(*term, total)
        return self.vector(0.0) if total is None else total

    def _newest(self, row: TaylorSeries, order: str, values: dict[TaylorSeries, str]) -> str:
        """The coefficient of a row at ``order``, which ``values`` hold or memory."""
        if row not in values:
            values[row] = self._at(row, order)
        return values[row]

    def _sum_known(self, order: str) -> None:
        """Of all products, the terms whose factors are known before ``order``.

        Those are Σ_j a_j b_(k-j) over 0 < j < k, and over 0 < j <= k with k + 1 for k of what is
        ahead. A loop holds many of them, since none waits for another.
        """
        plan, rows = self.plan, list(self.plan.factors)
        before, body, after = self.block, self.name("known"), self.name("all_known")
        several = self.count("icmp sgt", order, "1")
        self.lines.append(f"br i1 {several}, label %{body}, label %{after}")
        self.begin(body)
        sums: list[str] = []
        for first in range(0, len(rows), _AT_ONCE):
            sums += self._sum_some(rows[first : first + _AT_ONCE], order)
        body = self.block
        self.lines.append(f"br label %{after}")
        self.begin(after)
        for row, value in zip(rows, sums, strict=True):
            self.terms[row] = self.merged((before, self.vector(0.0)), (body, value))
        for row in filter(plan.is_ahead, rows):
            forward, backward = plan.factors[row]
            last = self._at(forward, order), self._at(backward, "1")
            self.terms[row] = self.fma(*last, self.terms[row])

    def _sum_some(self, rows: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j a_j b_(k-j) over 0 < j < ``order``."""

        def add_terms(index: str, *sums: str) -> list[str]:
            j = self.count("add", index, "1")
            opposite = self.count("sub", order, j), self.count("sub", order, index)
            added = []
            for row, total in zip(rows, sums, strict=True):
                forward, backward = self.plan.factors[row]
                factors = (
                    self._at(forward, j),
                    self._at(backward, opposite[self.plan.is_ahead(row)]),
                )
                added.append(self.fma(*factors, total))
            return added

        count = self.count("sub", order, "1")
        return self.repeat(count, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(
        self, products: list[TaylorSeries], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Enter the products of a stage at ``order``, with the terms of their newest factors."""
        for row in products:
            one, other = row.of if row.kind == "product" else (row, row.of[1])
            total = self.terms.get(row, self.vector(0.0))
            if row.kind == "product":
                total = self.fma(self._newest(one, order, values), self._at(other, _FIRST), total)
            if order != _FIRST:
                total = self.fma(self._at(one, _FIRST), self._newest(other, order, values), total)
            values[row] = self._finished(row, total, order) if row.kind == "quotient" else total
            if row in self.plan.place:
                self._keep(values[row], row, order)

    def _finished(self, quotient: TaylorSeries, others: str, order: str) -> str:
        """q_k = (a_k - Σ_(j<k) q_j b_(k-j)) / b_0."""
        top, bottom = quotient.of
        rest = self.do("fsub", self._at(top, order), others)
        return self.do("fdiv", rest, self._at(bottom, _FIRST))


class ErrorWriter(SeriesWriter):
    """Writes the function (errors, given, coefficients): the series of the linearised motion.

    ``errors`` holds the errors of the states; those of their coefficients up to ERROR_ORDER are
    entered, in the layout of ``coefficients``.
    """

    def __init__(self, name: str, plan: Plan) -> None:
        super().__init__(name, plan.of_accelerations())

    def _further_orders(self) -> str:
        return str(ERROR_ORDER - 1)

    def _begin_next(self, order: str, *_: str) -> None:
        """The terms of the errors at ``order``, of all rows that are ahead of it."""
        for row in filter(self.plan.is_ahead, self._rows()):
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                total = self.fma(self._at(one, order), self._coefficient(other, "1"), total)
            self.terms[row] = total

    def _rows(self) -> list[TaylorSeries]:
        """All rows with pairs."""
        return [*self.plan.sines[:2], *self.plan.products(True), *self.plan.products(False)]

    def _write_stages(self, order: str, ahead: bool) -> None:
        if ahead:
            self._complete(self.plan.sines[:2], order, self.ahead)
        super()._write_stages(order, ahead)

    def _total(
        self, _: Constant, terms: tuple[tuple[TaylorSeries, Constant], ...], *at: Any
    ) -> str:
        """The error of a sum; the excitation has none."""
        excitation = self.plan.sines[2:]
        return super()._total(0.0, tuple(each for each in terms if each[0] not in excitation), *at)

    def _pairs(self, row: TaylorSeries) -> tuple[tuple[TaylorSeries, TaylorSeries], ...]:
        """Pairs (a, b) of rows; Σ_j (error of a)_j b_(k-j) makes the error of ``row``."""
        sine, cosine = self.plan.sines[:2]
        if row in (sine, cosine):
            return ((STATES[TILT], cosine if row == sine else sine),)
        one, other = row.of if row.kind == "product" else (row, row.of[1])
        return (one, other), (other, one)

    def _coefficient(self, row: TaylorSeries, order: str) -> str:
        return self.load(*self._place(self.other, row, order))

    def _sum_known(self, order: str) -> None:
        """Of all pairs, the terms whose errors are of orders below ``order``."""
        rows = self._rows()
        for first in range(0, len(rows), _AT_ONCE):
            some = rows[first : first + _AT_ONCE]
            self.terms |= zip(some, self._sum_some(some, order), strict=True)

    def _sum_some(self, rows: list[TaylorSeries], order: str) -> list[str]:
        """Σ_j (error of a)_j b_(k-j) over j < ``order``, of all pairs of each row."""

        def add_terms(j: str, *sums: str) -> list[str]:
            behind = self.count("sub", order, j)
            opposite = behind, self.count("add", behind, "1")
            added = []
            for row, total in zip(rows, sums, strict=True):
                at = opposite[self.plan.is_ahead(row)]
                for one, other in self._pairs(row):
                    total = self.fma(self._at(one, j), self._coefficient(other, at), total)
                added.append(total)
            return added

        return self.repeat(order, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(
        self, rows: list[TaylorSeries], order: str, values: dict[TaylorSeries, str]
    ) -> None:
        """Enter the errors of rows at ``order``, with the terms of the newest errors."""
        for row in rows:
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                if one != row:
                    newest = self._newest(one, order, values)
                    total = self.fma(newest, self._coefficient(other, _FIRST), total)
            if row.kind == "quotient":
                top, bottom = row.of
                rest = self.do("fsub", self._newest(top, order, values), total)
                total = self.do("fdiv", rest, self._coefficient(bottom, _FIRST))
            values[row] = self.do("fneg", total) if row == self.plan.sines[1] else total
            if row in self.plan.place:
                self._keep(values[row], row, order)
