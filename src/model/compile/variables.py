"""Variables of a function: their types and places, and which names are assigned at a point.

A variable has one type wherever branches meet. Where an assignment gives it a wider one, the
function is translated again with that type from the start (``WidenedError``). A name that is not
assigned on every way to its use is an error.
"""

from collections.abc import Iterable
from typing import NamedTuple

from model.compile.code import Code
from model.compile.values import (
    Static,
    SubsetError,
    Type,
    Value,
    at_run_time,
    in_words,
    joined,
    type_of,
)


class Variable(NamedTuple):
    """A variable: its type, its place on the stack, and its value where that is known.

    A variable that never changes has no place. One with static items has them in its type, and as
    numbers of run time in its place.
    """

    type: Type
    place: Value | None
    value: Value | None = None


Names = dict[str, Variable]
"""The names that are assigned at a point of a function."""


def _at_run_time(variable: Variable) -> Variable:
    """Return a variable without what is known of its value."""
    if variable.place is None or variable.value is None:
        return variable
    return Variable(type_of(variable.place), variable.place)


class WidenedError(Exception):
    """A variable or the result has turned out to be wider."""


class Variables:
    """The variables of a function during one translation.

    Args:
        code: the code of the function.
        unchanging: names that are assigned at one place only.
        wider: for variables, types that earlier translations have found, kept for the next: those
            of which none can be joined with another.

    Attributes:
        assigned: names that are assigned at the present point.
    """

    def __init__(
        self, code: Code, unchanging: frozenset[str], wider: dict[str, list[Type]]
    ) -> None:
        self.assigned: Names = {}
        self._code, self._unchanging, self._wider = code, unchanging, wider
        self._places: dict[tuple[str, Type], Value] = {}
        self._conflicts: dict[str, str] = {}

    def assign(self, name: str, value: Value, keep_static: bool = False) -> None:
        """Assign a value; static numbers become numbers of run time, unless they are kept."""
        found, value = value, at_run_time(value)
        type_ = type_of(value)
        if name in self._unchanging:
            self.assigned[name] = Variable(type_, None, value)
            return
        for each in self._wider.get(name, ()):
            if (wider := joined(each, type_)) is not None:
                type_, value = wider, self._code.of_type(value, wider)
        if (name, type_) not in self._places:
            self._places[name, type_] = self._code.variable(type_)
        place = self._places[name, type_]
        self._code.store(value, place)
        is_static = keep_static and type_of(found) != type_of(at_run_time(found))
        self.assigned[name] = (
            Variable(type_of(found), place, found) if is_static else Variable(type_, place)
        )

    def value(self, name: str) -> Value:
        """Return the value of a variable of the function."""
        variable = self.assigned.get(name)
        if variable is None:
            if name in self._conflicts:
                raise SubsetError(f"{name!r} is {self._conflicts[name]}", "use two names")
            raise SubsetError(
                f"{name!r} is not assigned on every way to here", "assign it before the branch"
            )
        if variable.value is not None:
            return variable.value
        return self._code.load(variable.place)  # type: ignore[arg-type]

    def meet(self, ways: list[Names]) -> None:
        """Go on where ways meet, with the names that are assigned on each of them."""
        first, *others = ways
        self.assigned = {}
        for name, variable in first.items():
            found = [other[name] for other in others if name in other]
            if len(found) < len(others):
                continue
            if all(each.type == variable.type for each in found):
                self.assigned[name] = variable
                continue
            lasting = _at_run_time(variable)
            types = [_at_run_time(each).type for each in found]
            if all(each == lasting.type for each in types):
                self.assigned[name] = lasting
            else:
                self._reconcile(name, [lasting.type, *types])

    def begin_round(self, changing: Iterable[str]) -> None:
        """Begin the rounds of a loop that is repeated at run time, and assigns these names."""
        for name in changing:
            if name in self.assigned:
                self.assigned[name] = _at_run_time(self.assigned[name])

    def _reconcile(self, name: str, types: list[Type]) -> None:
        """Widen a variable that has several types where ways meet, or note that it cannot be."""
        if not any(isinstance(each, Static) for each in types):
            wider: Type | None = types[0]
            for each in types[1:]:
                wider = None if wider is None else joined(wider, each)
            if wider is not None:
                self._widen(name, wider)
        listed = " here and ".join(dict.fromkeys(map(in_words, types)))
        self._conflicts[name] = f"{listed} there"

    def check_round(self, before: Names, after: Names) -> None:
        """Check that a round of a loop leaves the types of what it began with as they were."""
        for name, variable in before.items():
            if name not in after:
                raise SubsetError(f"{name!r} is {self._conflicts[name]}", "use two names")
            if after[name].type == variable.type:
                continue
            wider = joined(after[name].type, variable.type)
            if wider is None:
                words = " and ".join(map(in_words, (variable.type, after[name].type)))
                raise SubsetError(f"{name!r} is {words} after a round of the loop", "use two names")
            self._widen(name, wider)

    def _widen(self, name: str, wider: Type) -> None:
        kept = self._wider.setdefault(name, [])
        both = [joined(each, wider) for each in kept]
        others = [each for each, one in zip(kept, both, strict=True) if one is None]
        for one in both:
            wider = wider if one is None else joined(wider, one) or wider
        if wider in kept:
            raise SubsetError(f"{name!r} changes its type to {in_words(wider)}", "use two names")
        self._wider[name] = [*others, wider]
        raise WidenedError
