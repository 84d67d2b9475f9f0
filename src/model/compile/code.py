"""Code of one function in LLVM's language, as it is written: blocks, instructions, variables.

Variables are places on the stack, which LLVM's optimiser turns into registers.
"""

from collections.abc import Callable, Iterable

from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    Array,
    Group,
    Number,
    SubsetError,
    Type,
    Value,
    at_run_time,
    constant,
    in_words,
    joined,
    known_number,
    leaf_kinds,
    leaves,
    rebuilt,
    type_of,
)

Places = list[tuple[str, str]]  # of a variable's leaves on the stack: (kind, address)

_CONVERSIONS = {
    (BOOLEAN, INTEGER): "zext i1 {} to i64",
    (BOOLEAN, DOUBLE): "uitofp i1 {} to double",
    (INTEGER, DOUBLE): "sitofp i64 {} to double",
    (DOUBLE, INTEGER): "fptosi double {} to i64",
    (DOUBLE, BOOLEAN): "fcmp une double {}, 0.0",
    (INTEGER, BOOLEAN): "icmp ne i64 {}, 0",
}
PYTHON_KINDS = {BOOLEAN: bool, INTEGER: int, DOUBLE: float}


class Code:
    """The code of one function.

    Attributes:
        closed: True after an instruction that leaves the block: what follows is never reached.
        contract: flag of instructions that may become fused multiply-adds, or nothing.
    """

    def __init__(self, contract: bool) -> None:
        self.contract = " contract" if contract else ""
        self.group = ""  # of accesses to memory in a loop over lanes, as instructions take it
        self._count = 0
        self._variables: list[str] = []
        self._blocks: list[str] = []
        self._lines: list[str] = []
        self.closed = True

    # ------------------------------------------------------------------------------------- blocks

    def text(self, head: str) -> str:
        """Return the whole function, after its ``head``."""
        entry = "\n".join(self._variables)
        return "\n".join([head + " {\nentry:", entry, "br label %begin", *self._lines, "}"])

    def label(self, what: str) -> str:
        """Return the name of a new block."""
        self._count += 1
        return f"{what}{self._count}"

    def begin(self, label: str) -> None:
        """Begin a block."""
        self._lines.append(f"{label}:")
        self.closed = False

    def put(self, text: str) -> None:
        """Write an instruction without a result."""
        self._lines.append(text)

    def do(self, text: str) -> str:
        """Write an instruction and return the name of its result."""
        self._count += 1
        name = f"%v{self._count}"
        self._lines.append(f"{name} = {text}")
        return name

    def leave(self, text: str) -> None:
        """Write the last instruction of a block."""
        self._lines.append(text)
        self.closed = True

    def jump(self, label: str) -> None:
        """Continue at a block, unless the present one has been left."""
        if not self.closed:
            self.leave(f"br label %{label}")

    def branch(self, condition: Number, yes: str, no: str) -> None:
        """Continue at one of two blocks."""
        self.leave(f"br i1 {condition.name}, label %{yes}, label %{no}")

    # ---------------------------------------------------------------------------------- variables

    def variable(self, type_: Type) -> Places:
        """Make a variable of this type."""
        places = []
        for kind in leaf_kinds(type_):
            self._count += 1
            name = f"%v{self._count}"
            self._variables.append(f"{name} = alloca {kind}")
            places.append((kind, name))
        return places

    def store(self, value: Value, places: Places) -> None:
        """Store a value of the variable's type."""
        for leaf, (kind, place) in zip(leaves(value), places, strict=True):
            self.put(f"store {kind} {leaf.name}, ptr {place}{self.group}")

    def load(self, type_: Type, places: Places) -> Value:
        """Load a variable of this type."""
        names = [self.do(f"load {kind}, ptr {at}{self.group}") for kind, at in places]
        return rebuilt(type_, iter(names))

    def read(self, place: Array) -> Number:
        """Load the number of a place, an array of no dimension."""
        return Number(place.kind, self.do(f"load {place.kind}, ptr {place.pointer}{self.group}"))

    def write(self, number: Value, place: Array) -> None:
        """Store a number at a place."""
        text = _typed(self.of_kind(number, place.kind))
        self.put(f"store {text}, ptr {place.pointer}{self.group}")

    def address(self, array: Array, offset: Value) -> str:
        """Return the address of a number of an array, ``offset`` numbers after the first."""
        place = at_run_time(offset)
        if isinstance(place, Number) and known_number(place) == 0:
            return array.pointer
        return self.do(f"getelementptr {array.kind}, ptr {array.pointer}, {_typed(place)}")

    # ------------------------------------------------------------------------------------ numbers

    def number(self, value: Value, what: str = "this") -> Number:
        """Return a value that must be a number."""
        found = at_run_time(value)
        if not isinstance(found, Number):
            raise SubsetError(
                f"{what} must be a number, and is {in_words(type_of(found))}", "pass one"
            )
        return found

    def of_kind(self, value: Value, kind: str) -> Number:
        """Return a number as one of another kind, as Python converts it."""
        number = self.number(value)
        if number.kind == kind:
            return number
        if (known := known_number(number)) is not None:
            return constant(PYTHON_KINDS[kind](known))
        return Number(kind, self.do(_CONVERSIONS[number.kind, kind].format(number.name)))

    def of_type(self, value: Value, type_: Type) -> Value:
        """Return a value as one of the wider ``type_`` with which its own has been ``joined``."""
        if type_of(value) == type_:
            return value
        if isinstance(type_, str):
            return self.of_kind(value, type_)
        value = at_run_time(value)
        if isinstance(value, Group):
            items = zip(value.items, type_.items, strict=True)  # type: ignore[union-attr]
            return Group(type_.made_by, tuple([self.of_type(*each) for each in items]))  # type: ignore[union-attr]
        return value

    def widened(self, one: Value, other: Value, least: str = BOOLEAN) -> tuple[Number, Number]:
        """Return two numbers as numbers of the wider kind, and at least of the kind ``least``."""
        kinds = [self.number(one).kind, self.number(other).kind, least]
        kind = max(kinds, key=(BOOLEAN, INTEGER, DOUBLE).index)
        return self.of_kind(one, kind), self.of_kind(other, kind)

    def arithmetic(self, operation: str, one: Value, other: Value) -> Number:
        """Return a sum, difference, product or quotient: "add", "sub", "mul" or "div"."""
        a, b = self.widened(one, other, DOUBLE if operation == "div" else INTEGER)
        if a.kind == DOUBLE:
            text = f"f{operation}{self.contract} double {a.name}, {b.name}"
            return Number(DOUBLE, self.do(text))
        return self.whole(operation, a, b)

    def whole(self, operation: str, one: Value, other: Value) -> Number:
        """Return the result of an instruction on integers, or on two booleans."""
        a, b = self.number(one), self.number(other)
        if a.kind != BOOLEAN or b.kind != BOOLEAN or operation not in ("and", "or", "xor"):
            if DOUBLE in (a.kind, b.kind):
                raise SubsetError("bits of a float", "take int(...) of it, or view it as np.int64")
            a, b = self.of_kind(a, INTEGER), self.of_kind(b, INTEGER)
        return Number(a.kind, self.do(f"{operation} {_typed(a)}, {b.name}"))

    def compare(self, how: str, one: Value, other: Value) -> Number:
        """Compare two numbers: "eq", "ne", "lt", "le", "gt" or "ge"."""
        a, b = self.widened(one, other)
        if a.kind == DOUBLE:
            condition = "une" if how == "ne" else f"o{how}"
            return Number(BOOLEAN, self.do(f"fcmp {condition} double {a.name}, {b.name}"))
        if a.kind == BOOLEAN and how not in ("eq", "ne"):
            a, b = self.of_kind(a, INTEGER), self.of_kind(b, INTEGER)
        condition = how if how in ("eq", "ne") else f"s{how}"
        return Number(BOOLEAN, self.do(f"icmp {condition} {_typed(a)}, {b.name}"))

    def select(self, condition: Number, yes: Value, no: Value) -> Value:
        """Return one of two values, both of which are computed."""
        type_ = joined(type_of(yes), type_of(no))
        if type_ is None:
            found = f"{in_words(type_of(yes))} or {in_words(type_of(no))}"
            raise SubsetError(f"a value that is {found}", "give both the same type")
        pairs = zip(
            leaves(self.of_type(yes, type_)), leaves(self.of_type(no, type_)), strict=True
        )  # fmt: skip
        text = f"select i1 {condition.name}, {{}}, {{}}"
        names = [self.do(text.format(_typed(a), _typed(b))) for a, b in pairs]
        return rebuilt(type_, iter(names))

    # -------------------------------------------------------------------------------------- calls

    def call(self, function: str, result: Type, arguments: Iterable[Value]) -> Value:
        """Call a function: a name of the module, or an address."""
        listed = ", ".join(_typed(leaf) for each in arguments for leaf in leaves(each))
        kinds = leaf_kinds(result)
        text = f"call {aggregate(kinds)} {function}({listed}){self.group}"
        if not kinds:
            self.put(text)
            return rebuilt(result, iter(()))
        found = self.do(text)
        if len(kinds) == 1:
            return rebuilt(result, iter([found]))
        parts = [
            self.do(f"extractvalue {aggregate(kinds)} {found}, {n}") for n in range(len(kinds))
        ]
        return rebuilt(result, iter(parts))

    def give_back(self, value: Value) -> None:
        """Return a value from the function."""
        found = [*leaves(value)]
        if not found:
            self.leave("ret void")
        elif len(found) == 1:
            self.leave(f"ret {_typed(found[0])}")
        else:
            whole, kind = "undef", aggregate([each.kind for each in found])
            for n, each in enumerate(found):
                whole = self.do(f"insertvalue {kind} {whole}, {_typed(each)}, {n}")
            self.leave(f"ret {kind} {whole}")

    # -------------------------------------------------------------------------------------- loops

    def repeat(self, count: Value, write: Callable[[Number], None]) -> None:
        """Write a loop of ``count`` rounds without a break; ``write(n)`` writes the n-th round."""
        places = self.variable(INTEGER)
        test, body, end = self.label("test"), self.label("round"), self.label("end")
        self.store(constant(0), places)
        self.jump(test)
        self.begin(test)
        n = self.number(self.load(INTEGER, places))
        self.branch(self.compare("lt", n, count), body, end)
        self.begin(body)
        write(n)
        self.store(self.whole("add", n, constant(1)), places)
        self.jump(test)
        self.begin(end)


def _typed(value: Value) -> str:
    """Return a number with its kind, as instructions take it."""
    if not isinstance(value, Number):
        raise SubsetError("this must be a number", "pass one")
    return f"{value.kind} {value.name}"


def aggregate(kinds: list[str]) -> str:
    """Return the type of a function's result with these leaves."""
    return "void" if not kinds else kinds[0] if len(kinds) == 1 else f"{{{', '.join(kinds)}}}"
