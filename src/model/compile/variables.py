"""Variables of a function: their types and places, and which names are assigned at a point.

A variable has one type wherever branches meet. Where an assignment gives it a wider one, the
function is translated again with that type from the start (``WidenedError``). A name that is not
assigned on every way to its use is an error.
"""

from typing import NamedTuple

from model.compile.code import Code, Places
from model.compile.values import (
    StaticType,
    SubsetError,
    Type,
    Value,
    at_run_time,
    in_words,
    joined,
    type_of,
)


class Variable(NamedTuple):
    """A variable: its type, and where it is on the stack or, if it never changes, its value."""

    type: Type
    places: Places
    value: Value | None = None


Names = dict[str, Variable]
"""The names that are assigned at a point of a function."""


class WidenedError(Exception):
    """A variable or the result has turned out to be wider."""


class Variables:
    """The variables of a function during one translation.

    Args:
        code: the code of the function.
        unchanging: names that are assigned at one place only.
        wider: types that earlier translations have found for variables, kept for the next.

    Attributes:
        assigned: names that are assigned at the present point.
    """

    def __init__(self, code: Code, unchanging: frozenset[str], wider: dict[str, Type]) -> None:
        self.assigned: Names = {}
        self._code, self._unchanging, self._wider = code, unchanging, wider
        self._places: dict[tuple[str, Type], Places] = {}
        self._conflicts: dict[str, str] = {}

    def assign(self, name: str, value: Value, keep_static: bool = False) -> None:
        """Assign a value; static numbers become numbers of run time, unless they are kept."""
        if not keep_static:
            value = at_run_time(value)
        type_ = type_of(value)
        if name in self._unchanging:
            self.assigned[name] = Variable(type_, [], value)
            return
        if name in self._wider:
            type_ = joined(self._wider[name], type_) or type_
            value = self._code.of_type(value, type_)
        if (name, type_) not in self._places:
            self._places[name, type_] = self._code.variable(type_)
        places = self._places[name, type_]
        self._code.store(value, places)
        self.assigned[name] = Variable(type_, places)

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
        return self._code.load(variable.type, variable.places)

    def meet(self, ways: list[Names]) -> None:
        """Go on where ways meet, with the names that are assigned on each of them."""
        first, *others = ways
        self.assigned = {}
        for name, variable in first.items():
            if not all(name in other for other in others):
                continue
            types = [variable.type, *(other[name].type for other in others)]
            if all(each == variable.type for each in types):
                self.assigned[name] = variable
            else:
                self._reconcile(name, types)

    def _reconcile(self, name: str, types: list[Type]) -> None:
        """Widen a variable that has several types where ways meet, or note that it cannot be."""
        if not any(isinstance(each, StaticType) for each in types):
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
        self._wider[name] = wider
        raise WidenedError
