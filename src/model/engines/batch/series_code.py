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
from model.physics.compiled import call_finished, kernel

_DOUBLE = ir.DoubleType()
_POINTER = ir.VectorType(_DOUBLE, WIDTH).as_pointer()
_VECTOR = f"<{WIDTH} x double>"
_FIRST = "0"  # order
_AT_ONCE = 14  # sums in a loop
_ALIGNMENT = 64


class _Writer:
    """Writes a function of pointers to vectors in LLVM's language.

    Vectors and whole numbers are names of values in the code, or constants. The text is written
    here, since llvmlite takes seven times as long for it. No vector is written after it was read.
    """

    def __init__(self, name: str, pointers: int) -> None:
        self.arguments = [f"%argument{n}" for n in range(pointers)]
        arguments = ", ".join(f"{_POINTER} noalias {each}" for each in self.arguments)
        self.lines = [
            f"declare {_VECTOR} @llvm.fmuladd.v{WIDTH}f64({_VECTOR}, {_VECTOR}, {_VECTOR})",
            f"declare {_VECTOR} @llvm.fabs.v{WIDTH}f64({_VECTOR})",
            f"define linkonce_odr void @{name}({arguments}) nounwind {{",
        ]
        self.begin("entry")

    def code(self) -> str:
        """Return the code of the function and of what it calls."""
        return "\n".join((*self.lines, "ret void", "}"))

    def begin(self, block: str) -> None:
        """Write what follows into a new block."""
        self.block = block
        self.bases: dict[tuple[str, str, int], str] = {}
        self.loaded: dict[tuple[str, str | int], str] = {}
        self.lines.append(f"{block}:")

    def name(self, what: str) -> str:
        """A name that the code does not contain yet."""
        return f"{what}{len(self.lines)}"

    def result(self, operation: str) -> str:
        """The result of an operation."""
        name = self.name("%v")
        self.lines.append(f"{name} = {operation}")
        return name

    def count(self, operation: str, a: str, b: str) -> str:
        """The result of an operation on whole numbers."""
        return self.result(f"{operation} i64 {a}, {b}")

    def do(self, operation: str, *of: str) -> str:
        """The result of an operation on vectors."""
        return self.result(f"{operation} {_VECTOR} {', '.join(of)}")

    def call(self, function: str, *of: str) -> str:
        """The result of a function of vectors."""
        listed = ", ".join(f"{_VECTOR} {each}" for each in of)
        return self.result(f"call {_VECTOR} @llvm.{function}.v{WIDTH}f64({listed})")

    def fma(self, a: str, b: str, c: str) -> str:
        """A b + c."""
        return self.call("fmuladd", a, b, c)

    def vector(self, number: float) -> str:
        """A vector with ``number`` everywhere."""
        return f"<{', '.join([str(ir.Constant(_DOUBLE, number))] * WIDTH)}>"

    def everywhere(self, count: str) -> str:
        """The same, of a whole number that the code computes."""
        number = self.result(f"sitofp i64 {count} to double")
        one = self.result(f"insertelement {_VECTOR} undef, double {number}, i64 0")
        first = f"<{WIDTH} x i32> zeroinitializer"
        return self.result(f"shufflevector {_VECTOR} {one}, {_VECTOR} undef, {first}")

    def address(self, pointer: str, place: str | int) -> str:
        """The address of the vector at a place."""
        return self.result(f"getelementptr {_VECTOR}, {_POINTER} {pointer}, i64 {place}")

    def base(self, pointer: str, index: str, rows: int = 1) -> str:
        """The address of the vector at ``index`` times ``rows``, computed once in a block."""
        key = pointer, index, rows
        if key not in self.bases:
            place = index if rows == 1 else self.count("mul", index, str(rows))
            self.bases[key] = self.address(pointer, place)
        return self.bases[key]

    def load(self, pointer: str, place: str | int) -> str:
        """The vector at a place, loaded once in a block."""
        if (pointer, place) not in self.loaded:
            address = self.address(pointer, place)
            loaded = self.result(f"load {_VECTOR}, {_POINTER} {address}, align {_ALIGNMENT}")
            self.loaded[pointer, place] = loaded
        return self.loaded[pointer, place]

    def keep(self, value: str, pointer: str, place: str | int) -> None:
        """Write the vector at a place."""
        address = self.address(pointer, place)
        self.lines.append(f"store {_VECTOR} {value}, {_POINTER} {address}, align {_ALIGNMENT}")
        self.loaded[pointer, place] = value

    def repeat(self, count: str, write: Callable[..., Sequence[str]], *starts: str) -> list[str]:
        """Write a loop: ``write(index, *carried)`` gives the values carried on; their last ones."""
        before, body, after = self.block, self.name("loop"), self.name("after")
        self.lines.append(f"br label %{body}")
        self.begin(body)
        first = len(self.lines)
        carried = [self.result("") for _ in ("0", *starts)]
        values = list(write(*carried))
        following = self.count("add", carried[0], "1")
        kinds = "i64", *[_VECTOR] * len(starts)
        phis = zip(kinds, ("0", *starts), (following, *values), strict=True)
        for n, (kind, start, value) in enumerate(phis, first):
            self.lines[n] += f"phi {kind} [{start}, %{before}], [{value}, %{self.block}]"
        goes_on = self.count("icmp slt", following, count)
        self.lines.append(f"br i1 {goes_on}, label %{body}, label %{after}")
        self.begin(after)
        return values


class _SeriesWriter(_Writer):
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
        self.terms: dict[Row, str] = {}
        self.ahead: dict[Row, str] = {}
        self._write_stages(_FIRST, ahead=True)
        self._one_order(_FIRST)
        self.repeat(self._further_orders(), self._one_more)

    def _further_orders(self) -> str:
        """The number of orders behind the first from which the next one is computed."""
        order = self.result(f"load double, {_DOUBLE.as_pointer()} {self.other}")
        return self.count("sub", self.result(f"fptosi double {order} to i64"), "1")

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

    def _place(self, memory: str, row: Row, order: str) -> tuple[str, int]:
        """Return the address of an order's rows, and the place of a row from there on."""
        place, rows, first = self.plan.place[row], ROWS, 0
        if place >= ROWS:
            place, rows, first = place - ROWS, FURTHER_ROWS, ORDERS * ROWS
        return self.base(memory, order, rows), first + place

    def _at(self, row: Row, order: str) -> str:
        return self.load(*self._place(self.memory, row, order))

    def _keep(self, value: str, row: Row, order: str) -> None:
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
        terms: tuple[tuple[Row, Constant], ...],
        order: str,
        values: dict[Row, str],
    ) -> str:
        """A constant and multiples of rows; those that ``values`` lacks are in memory."""
        total = self.constant(constant) if order == _FIRST and constant != 0.0 else None
        for row, factor in terms:
            term = self.constant(factor), self._newest(row, order, values)
            total = self.do("fmul", *term) if total is None else self.fma(*term, total)
        return self.vector(0.0) if total is None else total

    def _newest(self, row: Row, order: str, values: dict[Row, str]) -> str:
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
            chosen = f"[{self.vector(0.0)}, %{before}], [{value}, %{body}]"
            self.terms[row] = self.result(f"phi {_VECTOR} {chosen}")
        for row in filter(plan.is_ahead, rows):
            forward, backward = plan.factors[row]
            last = self._at(forward, order), self._at(backward, "1")
            self.terms[row] = self.fma(*last, self.terms[row])

    def _sum_some(self, rows: list[Row], order: str) -> list[str]:
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

    def _complete(self, products: list[Row], order: str, values: dict[Row, str]) -> None:
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

    def _finished(self, quotient: Row, others: str, order: str) -> str:
        """q_k = (a_k - Σ_(j<k) q_j b_(k-j)) / b_0."""
        top, bottom = quotient.of
        rest = self.do("fsub", self._at(top, order), others)
        return self.do("fdiv", rest, self._at(bottom, _FIRST))


class _ErrorWriter(_SeriesWriter):
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

    def _rows(self) -> list[Row]:
        """All rows with pairs."""
        return [*self.plan.sines[:2], *self.plan.products(True), *self.plan.products(False)]

    def _write_stages(self, order: str, ahead: bool) -> None:
        if ahead:
            self._complete(self.plan.sines[:2], order, self.ahead)
        super()._write_stages(order, ahead)

    def _total(self, _: Constant, terms: tuple[tuple[Row, Constant], ...], *at: Any) -> str:
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

    def _coefficient(self, row: Row, order: str) -> str:
        return self.load(*self._place(self.other, row, order))

    def _sum_known(self, order: str) -> None:
        """Of all pairs, the terms whose errors are of orders below ``order``."""
        rows = self._rows()
        for first in range(0, len(rows), _AT_ONCE):
            some = rows[first : first + _AT_ONCE]
            self.terms |= zip(some, self._sum_some(some, order), strict=True)

    def _sum_some(self, rows: list[Row], order: str) -> list[str]:
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

    def _complete(self, rows: list[Row], order: str, values: dict[Row, str]) -> None:
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


class _SamplesWriter(_Writer):
    """Writes the function (coefficients, lengths, values) that sums series at the nodes.

    ``count`` is the number of watched quantities.
    """

    def __init__(self, name: str, count: int) -> None:
        super().__init__(name, 3)
        self.coefficients, lengths, self.values = self.arguments
        self.length = self.load(lengths, 0)
        self.times = [self.do("fmul", self.length, self.vector(each)) for each in FRACTIONS]
        self.ratios = {  # of k (k - 1) h^k, from an order to the next
            order: self.do("fmul", self.length, self.vector((order + 1.0) / (order - 1.0)))
            for order in range(2, ORDER + 1)
        }
        self.repeat(str(STATE_ROWS), self._end_of_state)
        self.repeat(str(1 + count), self._one_row)

    def _coefficient(self, row: str, order: int) -> str:
        return self.load(self.base(self.coefficients, row), order * ROWS)

    def _enter(self, value: str, row: str, node: int) -> None:
        self.keep(value, self.base(self.values, row), node * SINES)

    def _end_of_state(self, row: str) -> tuple[()]:
        """One of the states at the last node: the others are not needed."""
        total = self.vector(0.0)
        for order in range(ORDER, -1, -1):
            total = self.fma(total, self.times[-1], self._coefficient(row, order))
        self._enter(total, row, NODES - 1)
        return ()

    def _one_row(self, index: str) -> tuple[()]:
        """Sum the tilt, or a watched quantity, at all nodes, and bound its second derivative."""
        is_first = self.count("icmp eq", index, "0")
        other = self.count("add", index, str(STATE_ROWS - 1))
        row = self.result(f"select i1 {is_first}, i64 {TILT}, i64 {other}")
        sums, bound = [self.vector(0.0) for _ in FRACTIONS], self.vector(0.0)
        for order in range(ORDER, -1, -1):
            coefficient = self._coefficient(row, order)
            for node, last in enumerate(ORDERS_THERE):
                if order <= last:
                    sums[node] = self.fma(sums[node], self.times[node], coefficient)
            if order > 1:
                bound = self.fma(bound, self.ratios[order], self.call("fabs", coefficient))
        square = self.do("fmul", self.length, self.length)
        bound = self.do("fmul", bound, self.do("fmul", self.vector(2.0), square))
        for node, value in enumerate((coefficient, *sums, bound)):
            self._enter(value, row, node)
        return ()


def _written(name: str, write: Callable[[str], _Writer]) -> Any:
    """The kernel (block, places) that calls a written function with pointers into ``block``."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        block = context.make_array(signature.args[0])(context, builder, arguments[0])
        first = builder.bitcast(block.data, _POINTER)
        pointers = [builder.gep(first, [place]) for place in unpack_tuple(builder, arguments[1])]
        call_finished(context, builder, name, write(name).code(), pointers)
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
        def write(label: str) -> _Writer:
            return writer(label, Plan(recurrences(kind, inserts)))

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
    sample = _written(f"sample_{count}", lambda name: _SamplesWriter(name, count))
    code = (
        "def sample_series(block, coefficients, lengths, values):\n"
        "    sample(block, (coefficients, lengths, values))"
    )
    return generated(kernel, "sample_series", code, {"sample": sample}, f"{count}_quantities")
