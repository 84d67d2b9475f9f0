"""Machine code of series: from the state of runs in a kind of mode to their coefficients.

The code is written for WIDTH runs, one in each lane of a vector, with the memory of series_plan.py:
``coefficients[order, row, lane]``.
"""

from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.cgutils import unpack_tuple
from numba.extending import intrinsic

from model.engines.batch.series import (
    STATES,
    Constant,
    Kind,
    Row,
    Sum,
    recurrences,
)
from model.engines.batch.series_plan import (
    ERROR_ORDER,
    FRACTIONS,
    FURTHER_ROWS,
    NODES,
    ORDER,
    ORDERS,
    ORDERS_THERE,
    ROWS,
    SINES,
    STATE_ROWS,
    TILT,
    WIDTH,
    Plan,
)
from model.events.kernel_set import generated
from model.physics.compiled import kernel

_DOUBLE, _INDEX = ir.DoubleType(), ir.IntType(64)
_FIRST = _INDEX(0)  # order
_AT_ONCE = 14  # sums in a loop
_VECTOR = ir.VectorType(_DOUBLE, WIDTH)
_POINTER = _VECTOR.as_pointer()
_ALIGNMENT = 64


class _Writer:
    """Writes a function of pointers to vectors."""

    def __init__(self, module: ir.Module, name: str, pointers: int) -> None:
        signature = ir.FunctionType(ir.VoidType(), [_POINTER] * pointers)
        self.function = ir.Function(module, signature, name)
        self.function.linkage = "internal"
        for each in self.function.args:
            each.add_attribute("noalias")
        self.code = ir.IRBuilder(self.function.append_basic_block("entry"))
        signature = ir.FunctionType(_VECTOR, [_VECTOR] * 3)
        self.add = module.declare_intrinsic(f"llvm.fmuladd.v{WIDTH}f64", (), signature)
        signature = ir.FunctionType(_VECTOR, [_VECTOR])
        self.size = module.declare_intrinsic(f"llvm.fabs.v{WIDTH}f64", (), signature)

    def vector(self, number: float) -> ir.Constant:
        """A vector with ``number`` everywhere."""
        return ir.Constant(_VECTOR, [number] * WIDTH)

    def everywhere(self, number: ir.Value) -> ir.Value:
        """The same, of a number that the code computes."""
        undefined = ir.Constant(_VECTOR, ir.Undefined)
        one = self.code.insert_element(undefined, number, _INDEX(0))
        first = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
        return self.code.shuffle_vector(one, undefined, first)

    def load(self, pointer: ir.Value, place: ir.Value) -> ir.Value:
        """The vector at a place."""
        return self.code.load(self.code.gep(pointer, [place]), align=_ALIGNMENT)

    def keep(self, value: ir.Value, pointer: ir.Value, place: ir.Value) -> None:
        """Write the vector at a place."""
        self.code.store(value, self.code.gep(pointer, [place]), align=_ALIGNMENT)

    def fma(self, a: ir.Value, b: ir.Value, c: ir.Value) -> ir.Value:
        """A b + c."""
        return self.code.call(self.add, [a, b, c])

    def repeat(
        self, count: ir.Value, write: Callable[[ir.Value], Sequence[ir.Value]], *starts: ir.Value
    ) -> list[ir.Value]:
        """Write a loop: ``write(index, *carried)`` gives the values carried on; their last ones."""
        before = self.code.block
        body = self.function.append_basic_block("loop")
        self.code.branch(body)
        self.code.position_at_end(body)
        index = self.code.phi(_INDEX)
        carried = [self.code.phi(each.type) for each in starts]
        values = list(write(index, *carried))
        following = self.code.add(index, _INDEX(1))
        for phi, start, value in zip(
            [index, *carried], [_INDEX(0), *starts], [following, *values], strict=True
        ):
            phi.add_incoming(start, before)
            phi.add_incoming(value, self.code.block)
        after = self.function.append_basic_block("after")
        self.code.cbranch(self.code.icmp_signed("<", following, count), body, after)
        self.code.position_at_end(after)
        return values


class _SeriesWriter(_Writer):
    """Writes the function (coefficients, given, last) that fills coefficients of a kind of mode.

    ``last`` holds the last order of the states.
    """

    def __init__(self, module: ir.Module, name: str, plan: Plan) -> None:
        super().__init__(module, name, 3)
        self.memory, self.given, self.other = self.function.args
        self.plan = plan
        self.known: dict[Constant, ir.Value] = {}
        totals = [Sum(row.of[0], dict(row.of[1])) for row in plan.stage if row.kind == "sum"]
        for total in (*totals, *plan.series.accelerations):
            for each in (total.constant, *total.terms.values()):
                self.constant(each)
        self.constant(plan.rate)
        self.terms: dict[Row, ir.Value] = {}
        self.ahead: dict[Row, ir.Value] = {}
        self._write_stages(_FIRST, ahead=True)
        self._one_order(_FIRST)
        self.repeat(self._further_orders(), self._one_more)
        self.code.ret_void()

    def _further_orders(self) -> ir.Value:
        """The number of orders behind the first from which the next one is computed."""
        order = self.code.extract_element(self.load(self.other, _INDEX(0)), _INDEX(0))
        return self.code.sub(self.code.fptosi(order, _INDEX), _INDEX(1))

    def constant(self, value: Constant) -> ir.Value:
        """A constant, computed before the first order."""
        if isinstance(value, float):
            return self.vector(value)
        if value not in self.known:
            kind, *of = value
            if kind == "given":
                self.known[value] = self.load(self.given, _INDEX(of[0]))
            else:
                do = {"+": self.code.fadd, "*": self.code.fmul, "/": self.code.fdiv}[kind]
                self.known[value] = do(*map(self.constant, of))
        return self.known[value]

    def _place(self, row: Row, order: ir.Value) -> ir.Value:
        place, rows, first = self.plan.place[row], ROWS, 0
        if place >= ROWS:
            place, rows, first = place - ROWS, FURTHER_ROWS, ORDERS * ROWS
        return self.code.add(self.code.mul(order, _INDEX(rows)), _INDEX(first + place))

    def _at(self, row: Row, order: ir.Value) -> ir.Value:
        return self.load(self.memory, self._place(row, order))

    def _keep(self, value: ir.Value, row: Row, order: ir.Value) -> None:
        self.keep(value, self.memory, self._place(row, order))

    def _one_more(self, index: ir.Value) -> tuple[()]:
        order = self.code.add(index, _INDEX(1))
        self._sum_known(order)
        self._one_order(order)
        return ()

    def _one_order(self, order: ir.Value) -> None:
        """Every row at ``order``, and from that the states, sines and cosines at the next."""
        plan, half = self.plan, len(STATES) // 2
        following = self.code.add(order, _INDEX(1))
        self.number = self.everywhere(self.code.sitofp(following, _DOUBLE))
        per_order = self.code.fdiv(self.vector(1.0), self.number)
        self.value = {row: self._at(row, order) for row in STATES[half:]}
        for n in range(half):
            position = self.code.fmul(self.value[STATES[half + n]], per_order)
            self._keep(position, STATES[n], following)
        self._begin_next(order, following, per_order)
        self.ahead = {}
        self._write_stages(following, ahead=True)
        self._write_stages(order, ahead=False)
        for n, total in enumerate(plan.series.accelerations):
            rate = self._total(total.constant, tuple(total.terms.items()), order, self.value)
            self._keep(self.code.fmul(rate, per_order), STATES[half + n], following)

    def _begin_next(self, order: ir.Value, following: ir.Value, per_order: ir.Value) -> None:
        """The sines and cosines at ``following``, from the rows at ``order``."""
        plan = self.plan
        self.value |= {row: self._at(row, order) for row in plan.sines[2:]}
        self._complete(plan.turning, order, self.value)
        sine, cosine, swing, other = plan.sines
        turns, turned = (self.value[row] for row in plan.turning)
        self._keep(self.code.fmul(turned, per_order), sine, following)
        self._keep(self.code.fmul(turns, self.code.fneg(per_order)), cosine, following)
        rate = self.code.fmul(self.constant(plan.rate), per_order)
        self._keep(self.code.fmul(rate, self.value[other]), swing, following)
        self._keep(self.code.fmul(self.code.fneg(rate), self.value[swing]), other, following)

    def _write_stages(self, order: ir.Value, ahead: bool) -> None:
        """All rows that are made of positions alone, or all others, at ``order``."""
        plan = self.plan
        values = self.ahead if ahead else self.value
        for products, others in plan.stages(ahead):
            self._complete(products, order, values)
            for row in others:
                if row.kind == "rate":
                    values[row] = self.code.fmul(self.ahead[row.of[0]], self.number)
                else:
                    values[row] = self._total(row.of[0], row.of[1], order, values)
                if row in plan.place:
                    self._keep(values[row], row, order)

    def _total(
        self,
        constant: Constant,
        terms: tuple[tuple[Row, Constant], ...],
        order: ir.Value,
        values: dict[Row, ir.Value],
    ) -> ir.Value:
        """A constant and multiples of rows; those that ``values`` lacks are in memory."""
        total = self.constant(constant) if order is _FIRST and constant != 0.0 else None
        for row, factor in terms:
            term = self.constant(factor), self._newest(row, order, values)
            total = self.code.fmul(*term) if total is None else self.fma(*term, total)
        return self.vector(0.0) if total is None else total

    def _newest(self, row: Row, order: ir.Value, values: dict[Row, ir.Value]) -> ir.Value:
        """The coefficient of a row at ``order``, which ``values`` hold or memory."""
        if row not in values:
            values[row] = self._at(row, order)
        return values[row]

    def _sum_known(self, order: ir.Value) -> None:
        """Of all products, the terms whose factors are known before ``order``.

        Those are Σ_j a_j b_(k-j) over 0 < j < k, and over 0 < j <= k with k + 1 for k of what is
        ahead. A loop holds many of them, since none waits for another.
        """
        plan, rows = self.plan, list(self.plan.factors)
        before, body = self.code.block, self.function.append_basic_block("known")
        after = self.function.append_basic_block("all_known")
        self.code.cbranch(self.code.icmp_signed(">", order, _INDEX(1)), body, after)
        self.code.position_at_end(body)
        sums: list[ir.Value] = []
        for first in range(0, len(rows), _AT_ONCE):
            sums += self._sum_some(rows[first : first + _AT_ONCE], order)
        body = self.code.block
        self.code.branch(after)
        self.code.position_at_end(after)
        for row, value in zip(rows, sums, strict=True):
            self.terms[row] = self.code.phi(_VECTOR)
            self.terms[row].add_incoming(self.vector(0.0), before)
            self.terms[row].add_incoming(value, body)
        for row in filter(plan.is_ahead, rows):
            forward, backward = plan.factors[row]
            last = self._at(forward, order), self._at(backward, _INDEX(1))
            self.terms[row] = self.fma(*last, self.terms[row])

    def _sum_some(self, rows: list[Row], order: ir.Value) -> list[ir.Value]:
        """Σ_j a_j b_(k-j) over 0 < j < ``order``."""

        def add_terms(index: ir.Value, *sums: ir.Value) -> list[ir.Value]:
            j = self.code.add(index, _INDEX(1))
            opposite = self.code.sub(order, j), self.code.sub(order, index)
            loaded: dict[tuple[Row, ir.Value], ir.Value] = {}
            added = []
            for row, total in zip(rows, sums, strict=True):
                forward, backward = self.plan.factors[row]
                factors = (forward, j), (backward, opposite[self.plan.is_ahead(row)])
                for each in factors:
                    if each not in loaded:
                        loaded[each] = self._at(*each)
                added.append(self.fma(loaded[factors[0]], loaded[factors[1]], total))
            return added

        count = self.code.sub(order, _INDEX(1))
        return self.repeat(count, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(self, products: list[Row], order: ir.Value, values: dict[Row, ir.Value]) -> None:
        """Enter the products of a stage at ``order``, with the terms of their newest factors."""
        for row in products:
            one, other = row.of if row.kind == "product" else (row, row.of[1])
            total = self.terms.get(row, self.vector(0.0))
            if row.kind == "product":
                total = self.fma(self._newest(one, order, values), self._at(other, _FIRST), total)
            if order is not _FIRST:
                total = self.fma(self._at(one, _FIRST), self._newest(other, order, values), total)
            values[row] = self._finished(row, total, order) if row.kind == "quotient" else total
            if row in self.plan.place:
                self._keep(values[row], row, order)

    def _finished(self, quotient: Row, others: ir.Value, order: ir.Value) -> ir.Value:
        """q_k = (a_k - Σ_(j<k) q_j b_(k-j)) / b_0."""
        top, bottom = quotient.of
        rest = self.code.fsub(self._at(top, order), others)
        return self.code.fdiv(rest, self._at(bottom, _FIRST))


class _ErrorWriter(_SeriesWriter):
    """Writes the function (errors, given, coefficients): the series of the linearised motion.

    ``errors`` holds the errors of the states; those of their coefficients up to ERROR_ORDER are
    entered, in the layout of ``coefficients``.
    """

    def __init__(self, module: ir.Module, name: str, plan: Plan) -> None:
        super().__init__(module, name, plan.of_accelerations())

    def _further_orders(self) -> ir.Value:
        return _INDEX(ERROR_ORDER - 1)

    def _begin_next(self, order: ir.Value, *_: ir.Value) -> None:
        """The terms of the errors at ``order``, of all rows that are ahead of it."""
        for row in filter(self.plan.is_ahead, self._rows()):
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                total = self.fma(self._at(one, order), self._coefficient(other, _INDEX(1)), total)
            self.terms[row] = total

    def _rows(self) -> list[Row]:
        """All rows with pairs."""
        return [*self.plan.sines[:2], *self.plan.products(True), *self.plan.products(False)]

    def _write_stages(self, order: ir.Value, ahead: bool) -> None:
        if ahead:
            self._complete(self.plan.sines[:2], order, self.ahead)
        super()._write_stages(order, ahead)

    def _total(self, _: Constant, terms: tuple[tuple[Row, Constant], ...], *at: Any) -> ir.Value:
        """The error of a sum; the excitation has none."""
        excitation = self.plan.sines[2:]
        return super()._total(0.0, tuple(each for each in terms if each[0] not in excitation), *at)

    def _pairs(self, row: Row) -> tuple[tuple[Row, Row], ...]:
        """Pairs (a, b) of rows; Σ_j (error of a)_j b_(k-j) makes the error of ``row``."""
        sine, cosine = self.plan.sines[:2]
        if row in (sine, cosine):
            return ((STATES[TILT], cosine if row == sine else sine),)
        one, other = row.of if row.kind == "product" else (row, row.of[1])
        return (one, other), (other, one)

    def _coefficient(self, row: Row, order: ir.Value) -> ir.Value:
        return self.load(self.other, self._place(row, order))

    def _sum_known(self, order: ir.Value) -> None:
        """Of all pairs, the terms whose errors are of orders below ``order``."""
        rows = self._rows()
        for first in range(0, len(rows), _AT_ONCE):
            some = rows[first : first + _AT_ONCE]
            self.terms |= zip(some, self._sum_some(some, order), strict=True)

    def _sum_some(self, rows: list[Row], order: ir.Value) -> list[ir.Value]:
        """Σ_j (error of a)_j b_(k-j) over j < ``order``, of all pairs of each row."""

        def add_terms(j: ir.Value, *sums: ir.Value) -> list[ir.Value]:
            opposite = self.code.sub(order, j)
            opposite = opposite, self.code.add(opposite, _INDEX(1))
            errors, coefficients, added = {}, {}, []
            for row, total in zip(rows, sums, strict=True):
                ahead = self.plan.is_ahead(row)
                for one, other in self._pairs(row):
                    if one not in errors:
                        errors[one] = self._at(one, j)
                    if (other, ahead) not in coefficients:
                        coefficients[other, ahead] = self._coefficient(other, opposite[ahead])
                    total = self.fma(errors[one], coefficients[other, ahead], total)
                added.append(total)
            return added

        return self.repeat(order, add_terms, *(self.vector(0.0) for _ in rows))

    def _complete(self, rows: list[Row], order: ir.Value, values: dict[Row, ir.Value]) -> None:
        """Enter the errors of rows at ``order``, with the terms of the newest errors."""
        for row in rows:
            total = self.terms.get(row, self.vector(0.0))
            for one, other in self._pairs(row):
                if one != row:
                    newest = self._newest(one, order, values)
                    total = self.fma(newest, self._coefficient(other, _FIRST), total)
            if row.kind == "quotient":
                top, bottom = row.of
                rest = self.code.fsub(self._newest(top, order, values), total)
                total = self.code.fdiv(rest, self._coefficient(bottom, _FIRST))
            values[row] = self.code.fneg(total) if row == self.plan.sines[1] else total
            if row in self.plan.place:
                self._keep(values[row], row, order)


class _SamplesWriter(_Writer):
    """Writes the function (coefficients, lengths, values) that sums series at the nodes.

    ``count`` is the number of watched quantities.
    """

    def __init__(self, module: ir.Module, name: str, count: int) -> None:
        super().__init__(module, name, 3)
        self.coefficients, lengths, self.values = self.function.args
        self.length = self.load(lengths, _INDEX(0))
        self.times = [self.code.fmul(self.length, self.vector(each)) for each in FRACTIONS]
        self.ratios = {  # of k (k - 1) h^k, from an order to the next
            order: self.code.fmul(self.length, self.vector((order + 1.0) / (order - 1.0)))
            for order in range(2, ORDER + 1)
        }
        self.repeat(_INDEX(STATE_ROWS), self._end_of_state)
        self.repeat(_INDEX(1 + count), self._one_row)
        self.code.ret_void()

    def _coefficient(self, row: ir.Value, order: int) -> ir.Value:
        return self.load(self.coefficients, self.code.add(row, _INDEX(order * ROWS)))

    def _end_of_state(self, row: ir.Value) -> tuple[()]:
        """One of the states at the last node: the others are not needed."""
        total = self.vector(0.0)
        for order in range(ORDER, -1, -1):
            total = self.fma(total, self.times[-1], self._coefficient(row, order))
        self.keep(total, self.values, self.code.add(row, _INDEX((NODES - 1) * SINES)))
        return ()

    def _one_row(self, index: ir.Value) -> tuple[()]:
        """Sum the tilt, or a watched quantity, at all nodes, and bound its second derivative."""
        is_first = self.code.icmp_signed("==", index, _INDEX(0))
        row = self.code.select(is_first, _INDEX(TILT), self.code.add(index, _INDEX(STATE_ROWS - 1)))
        sums, bound = [self.vector(0.0) for _ in FRACTIONS], self.vector(0.0)
        for order in range(ORDER, -1, -1):
            coefficient = self._coefficient(row, order)
            for node, last in enumerate(ORDERS_THERE):
                if order <= last:
                    sums[node] = self.fma(sums[node], self.times[node], coefficient)
            if order > 1:
                size = self.code.call(self.size, [coefficient])
                bound = self.fma(bound, self.ratios[order], size)
        square = self.code.fmul(self.length, self.length)
        bound = self.code.fmul(bound, self.code.fmul(self.vector(2.0), square))
        for node, value in enumerate((coefficient, *sums, bound)):
            self.keep(value, self.values, self.code.add(row, _INDEX(node * SINES)))
        return ()


def _written(name: str, write: Callable[[ir.Module, str], _Writer]) -> Any:
    """The kernel (block, places) that calls a written function with pointers into ``block``."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        function = builder.module.globals.get(name)
        if function is None:
            function = write(builder.module, name).function
        block = context.make_array(signature.args[0])(context, builder, arguments[0])
        first = builder.bitcast(block.data, _POINTER)
        places = unpack_tuple(builder, arguments[1])
        builder.call(function, [builder.gep(first, [place]) for place in places])
        return context.get_dummy_value()

    @intrinsic
    def call(_context: Any, block: Any, places: Any) -> Any:
        return types.void(block, places), generate

    return call


def _filler(
    name: str, writer: type[_SeriesWriter], kinds: Sequence[Kind], inserts: bool, places: str
) -> Any:
    """Make the kernel (kind, block, ``places``) that calls the function written for a kind."""

    def written(kind: Kind) -> Any:
        def write(module: ir.Module, label: str) -> _Writer:
            return writer(module, label, Plan(recurrences(kind, inserts)))

        return _written("_".join(map(str, (name, inserts, *kind))), write)

    known, lines = {}, [f"def {name}(kind, block, {places}):"]
    for number, kind in enumerate(kinds):
        known[f"series_{number}"] = written(kind)
        lines.append(f"    if kind == {number}: series_{number}(block, ({places}))")
    return generated(kernel, name, "\n".join(lines), known, f"{len(kinds)}_kinds")


def series_filler(kinds: Sequence[Kind], inserts: bool) -> Any:
    """Make the kernel (kind, block, coefficients, given, last) that fills the coefficients of runs.

    ``block`` holds vectors on cache lines. At the place ``coefficients`` in it stand ROWS of them
    for each order, of which the first holds the states and sines; at ``given``, GIVEN of them; at
    ``last`` the last order of the states. ``kind`` is an index of ``kinds``; ``inserts`` as in
    ``recurrences``.
    """
    places = "coefficients, given, last"
    return _filler("fill_series", _SeriesWriter, kinds, inserts, places)


def errors_filler(kinds: Sequence[Kind], inserts: bool) -> Any:
    """Make the kernel (kind, block, errors, given, coefficients) that fills the series of errors.

    The coefficients are filled. At ``errors`` stand the errors of the states, in the layout of the
    coefficients, up to ERROR_ORDER; the first is given.
    """
    return _filler("fill_errors", _ErrorWriter, kinds, inserts, "errors, given, coefficients")


def series_sampler(count: int) -> Any:
    """Make the kernel (block, coefficients, lengths, values) that sums series at nodes of steps.

    It sums the tilt and the first ``count`` watched quantities at the nodes of steps of the given
    ``lengths``. At ``values`` stand SINES vectors for each node and, behind them, as many bounds of
    the second derivative with respect to the fraction of the step. The other states are summed at
    the last node only.
    """
    sample = _written(f"sample_{count}", lambda module, name: _SamplesWriter(module, name, count))
    code = (
        "def sample_series(block, coefficients, lengths, values):\n"
        "    sample(block, (coefficients, lengths, values))"
    )
    return generated(kernel, "sample_series", code, {"sample": sample}, f"{count}_quantities")
