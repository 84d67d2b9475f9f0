"""Variables of a function: their types and places, and which names are assigned at a point.

A variable has one type wherever branches meet. A name that is not assigned on every way to its use,
or has another type on another way, is an error.
"""

from typing import NamedTuple

from model.compile.code import Code
from model.compile.values import SubsetError, Type, Value, at_run_time, in_words, type_of


class Variable(NamedTuple):
    """A variable: its type, and its place on the stack or, if it never changes, its value."""

    type: Type
    place: Value | None
    value: Value | None = None


Names = dict[str, Variable]
"""The names that are assigned at a point of a function."""


class Variables:
    """The variables of a function.

    Args:
        code: the code of the function.
        unchanging: names that are assigned at one place only.

    Attributes:
        assigned: names that are assigned at the present point.
    """

    def __init__(self, code: Code, unchanging: frozenset[str]) -> None:
        self.assigned: Names = {}
        self._code, self._unchanging = code, unchanging
        self._places: dict[tuple[str, Type], Value] = {}
        self._conflicts: dict[str, str] = {}

    def assign(self, name: str, value: Value, keep_static: bool = False) -> None:
        """Assign a value; static numbers become numbers of run time, unless they are kept."""
        if not keep_static:
            value = at_run_time(value)
        type_ = type_of(value)
        if name in self._unchanging:
            self.assigned[name] = Variable(type_, None, value)
            return
        if (name, type_) not in self._places:
            self._places[name, type_] = self._code.variable(type_)
        place = self._places[name, type_]
        self._code.store(value, place)
        self.assigned[name] = Variable(type_, place)

    def value(self, name: str) -> Value:
        """Return the value of a variable of the function."""
        variable = self.assigned.get(name)
        if variable is None:
            if name in self._conflicts:
                raise SubsetError(
                    f"{name!r} is {self._conflicts[name]}", "give it one type, or use two names"
                )
            raise SubsetError(
                f"{name!r} is not assigned on every way to here", "assign it before the branch"
            )
        if variable.place is None:
            return variable.value  # type: ignore[return-value]
        return self._code.load(variable.place)

    def meet(self, ways: list[Names]) -> None:
        """Go on where ways meet, with the names that are assigned on each of them."""
        first, *others = ways
        self.assigned = {}
        for name, variable in first.items():
            found = [other[name].type for other in others if name in other]
            if len(found) == len(others) and all(each == variable.type for each in found):
                self.assigned[name] = variable
            elif len(found) == len(others):
                kinds = dict.fromkeys(map(in_words, (variable.type, *found)))
                self._conflicts[name] = f"{' here and '.join(kinds)} there"

    def check_round(self, before: Names, after: Names) -> None:
        """Check that a round of a loop leaves the types of what it began with as they were."""
        for name, variable in before.items():
            if name not in after or after[name].type != variable.type:
                other = after[name].type if name in after else None
                words = self._conflicts[name] if other is None else in_words(other)
                raise SubsetError(
                    f"{name!r} is {in_words(variable.type)} before a round of the loop and {words} "
                    "after it", "give it one type, or use two names",
                )  # fmt: skip
