"""Levels of events as linear forms of workspace rows, by symbolic tracing.

Input: a level of the event table. Output: a ``LinearForm`` of each of its quantities, which
event_kernels.py writes into kernels. A level is called once with symbols in place of numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import mul
from typing import Any

from model.compile.jit import Symbol, python_of
from model.events.event_functions import ContactState, CornerPositions
from model.events.insertion import LEFT_WALL, RIGHT_SIDE, RIGHT_WALL
from model.events.table import FACE, FORCES, PLACES, SIDE, Source
from model.physics.modes import CLOSED, Mode
from model.physics.motion import Motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Constants

Number = float | str  # a number, or source text of the constants of a run


def _times(a: Number, b: Number) -> Number:
    if isinstance(a, float) and isinstance(b, float):
        return a * b
    return f"({a} * {b})"


@dataclass(frozen=True, eq=False)
class LinearForm(Symbol):
    """A constant plus multiples of rows, or of the absolute value of such a sum.

    Attributes:
        tree: the expression: (operation, operands), ("row", name), ("constant", text or number).
        factors: factor of each row, up to its sign.
        has_absolute: True if it contains an absolute value.
        is_known: False for a quantity that no row holds, or that is not linear in the rows.
    """

    tree: tuple[Any, ...]
    factors: dict[str, Number]
    has_absolute: bool = False
    is_known: bool = True

    def _with(self, operation: str, other: Any, factors: dict[str, Number]) -> "LinearForm":
        return LinearForm(
            (operation, self.tree, other.tree), factors, self.has_absolute or other.has_absolute,
            self.is_known and other.is_known,
        )  # fmt: skip

    def _sum(self, operation: str, other: Any) -> "LinearForm":
        other = _as_form(other)
        factors = dict(self.factors)
        for row, factor in other.factors.items():
            factors[row] = f"({factors[row]} + {factor})" if row in factors else factor
        return self._with(operation, other, factors)

    def __add__(self, other: Any) -> "LinearForm":
        return self._sum("+", other)

    def __sub__(self, other: Any) -> "LinearForm":
        return self._sum("-", other)

    def __rsub__(self, other: Any) -> "LinearForm":
        return _as_form(other) - self

    def __radd__(self, other: Any) -> "LinearForm":
        return _as_form(other) + self

    def __rmul__(self, other: Any) -> "LinearForm":
        return _as_form(other) * self

    def __mul__(self, other: Any) -> "LinearForm":
        other = _as_form(other)
        if self.factors and other.factors:
            return UNKNOWN
        one, constant = (self, other) if self.factors else (other, self)
        operation, *value = constant.tree
        number = operation == "constant" and isinstance(value[0], float)
        by: Number = value[0] if number else rendered(constant, str)
        factors = {row: _times(factor, by) for row, factor in one.factors.items()}
        return self._with("*", other, factors)

    def __neg__(self) -> "LinearForm":
        return LinearForm(("neg", self.tree), self.factors, self.has_absolute, self.is_known)

    def __abs__(self) -> "LinearForm":
        return LinearForm(
            ("abs", self.tree), self.factors, True, self.is_known and not self.has_absolute
        )

    def __eq__(self, other: object) -> bool:
        raise TypeError("a level must not branch on its quantities: state another case")

    __hash__ = None  # type: ignore[assignment]


UNKNOWN = LinearForm(("constant", "NOTHING"), {}, is_known=False)


def _as_form(value: Any) -> LinearForm:
    return value if isinstance(value, LinearForm) else LinearForm(("constant", float(value)), {})


def _constant(text: str) -> Any:
    return LinearForm(("constant", text), {})


def _row(name: str) -> Any:
    return LinearForm(("row", name), {name: 1.0})


def rendered(form: LinearForm, row: Callable[[str], str], absolute: str = "abs({})") -> str:
    """Return the form as source text, with ``row`` of each name, and this text of ``absolute``."""

    def text(tree: tuple[Any, ...]) -> str:
        operation, *of = tree
        if operation == "constant":
            return of[0] if isinstance(of[0], str) else repr(of[0])
        if operation == "row":
            return row(of[0])
        if operation == "abs":
            return absolute.format(text(of[0]))
        if operation == "neg":
            return f"(-{text(of[0])})"
        return f"({text(of[0])} {operation} {text(of[1])})"

    return text(form.tree)


P: Any = Constants(
    *(
        0.0 if name.startswith("printed_") else _constant(f"p.{name}")
        for name in Constants._fields
    )
)  # fmt: skip
MODE: Any = Mode(*(_constant(f"mode.{name}") for name in Mode._fields))


def _if(condition: str) -> Any:
    return _constant(f"(1.0 if {condition} else 0.0)")


def _quantities(inserts: bool) -> dict[Source, Any]:
    """Quantities of every source that the workspace holds, as forms of its rows.

    The sources are the corner positions, the contacts of the edges and, if the scene ``inserts``,
    of the corners with the walls. Without insertion the support is A1.
    """
    places = {name: _row(name) for name in CornerPositions._fields if not name.endswith("_rise")}
    unknown = dict.fromkeys(CornerPositions._fields, UNKNOWN)
    forces: dict[str, Any] = dict.fromkeys(Motion._fields, UNKNOWN)
    sides = ("support", "face", "corner"), ("side", "side", "wall")
    for place, edge, corner in sides:
        friction = _row(f"{place}_friction")  # or the slip of a sliding contact
        forces |= {f"{place}_slip": friction, f"{place}_friction": friction}
        forces[f"{place}_load"] = _row(f"{edge}_load")
        if inserts:
            presses = (_if(f"mode.{each} == {CLOSED}") for each in (edge, corner))
            loads = (_row(f"{each}_load") for each in (edge, corner))
            edge_load, corner_load = map(mul, presses, loads)
            forces[f"{place}_load"] = edge_load + corner_load
    along_face, along_axis = places["right_along_face"], places["right_along_axis"]
    if inserts:
        right, left = _if(f"mode.edge == {RIGHT_EDGE}"), _if(f"mode.edge == {LEFT_EDGE}")
        along_face = right * along_face + left * places["left_along_face"]
        along_axis = right * along_axis + left * places["left_along_axis"]
    sources = {
        PLACES: CornerPositions(**(unknown | places)),
        FACE: ContactState(P.half_height + along_axis, _row("face_load"), along_face),
        SIDE: ContactState(
            places["left_behind_side"], _row("side_load"), places["left_along_axis"]
        ),
        FORCES: Motion(**forces),
    }
    return sources if not inserts else sources | {
        RIGHT_SIDE: ContactState(
            P.half_width - places["right_along_face"], _row("face_load"),
            places["right_along_axis"],
        ),
        RIGHT_WALL: ContactState(
            places["right_corner_x"] - P.slot_half_width, _row("corner_load"),
            places["right_corner_y"],
        ),
        LEFT_WALL: ContactState(
            -places["left_corner_x"] - P.slot_half_width, _row("wall_load"),
            places["left_corner_y"],
        ),
    }  # fmt: skip


QUANTITIES = {inserts: _quantities(inserts) for inserts in (False, True)}


def forms_of(
    source: Source, level: Callable[..., Any], inserts: bool
) -> tuple[LinearForm, ...] | None:
    """Return the quantities of a level as forms; None if the workspace does not hold its source.

    Of a level's four quantities, one that it lacks is the constant NOTHING, and one that no row
    holds is not ``is_known``.
    """
    if source not in QUANTITIES[inserts]:
        return None
    mode = MODE if inserts else MODE._replace(edge=RIGHT_EDGE)
    forms = python_of(level)(QUANTITIES[inserts][source], P, mode)
    return tuple(map(_as_form, forms if isinstance(forms, tuple) else (forms,)))
