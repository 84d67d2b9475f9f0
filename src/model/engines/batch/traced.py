"""Level functions as expressions of the rows of a SIMD workspace, by symbolic tracing.

A level is called once with symbols in place of numbers. The returned expression is written into
kernels in the forms that the batch engine needs. It yields the factor of each row, the presence of
an absolute value, and the quantities that no row holds.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import mul
from typing import Any

from model.compile.jit import Symbol, python_of
from model.events.insertion import LEFT_WALL, RIGHT_SIDE, RIGHT_WALL
from model.events.levels import NOTHING, ContactState, CornerPositions
from model.events.table import FACE, FORCES, PLACES, SIDE, Source
from model.physics.modes import CLOSED, Mode
from model.physics.motion import Motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Constants

Number = float | str  # or an expression of the constants of a run


def _times(a: Number, b: Number) -> Number:
    if isinstance(a, float) and isinstance(b, float):
        return a * b
    return f"({a} * {b})"


@dataclass(frozen=True, eq=False)
class LinearForm(Symbol):
    """A constant plus multiples of rows, or of the absolute value of such a sum.

    Attributes:
        tree: the expression: (operation, operands), ("row", name), ("constant", text or number).
        factors: of each row, up to the sign.
        takes_size: True if there is an absolute value.
        is_known: False for a quantity that no row holds, or that is not linear in them.
    """

    tree: tuple[Any, ...]
    factors: dict[str, Number]
    takes_size: bool = False
    is_known: bool = True

    def _with(self, operation: str, other: Any, factors: dict[str, Number]) -> "LinearForm":
        return LinearForm(
            (operation, self.tree, other.tree), factors, self.takes_size or other.takes_size,
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
        kind, *value = constant.tree
        number = kind == "constant" and isinstance(value[0], float)
        by: Number = value[0] if number else rendered(constant, str)
        factors = {row: _times(factor, by) for row, factor in one.factors.items()}
        return self._with("*", other, factors)

    def __neg__(self) -> "LinearForm":
        return LinearForm(("neg", self.tree), self.factors, self.takes_size, self.is_known)

    def __abs__(self) -> "LinearForm":
        return LinearForm(
            ("abs", self.tree), self.factors, True, self.is_known and not self.takes_size
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


def rendered(form: LinearForm, row: Callable[[str], str], size: str = "abs({})") -> str:
    """Return the expression with other texts for rows and absolute values."""

    def text(tree: tuple[Any, ...]) -> str:
        kind, *of = tree
        if kind == "constant":
            return of[0] if isinstance(of[0], str) else repr(of[0])
        if kind == "row":
            return row(of[0])
        if kind == "abs":
            return size.format(text(of[0]))
        if kind == "neg":
            return f"(-{text(of[0])})"
        return f"({text(of[0])} {kind} {text(of[1])})"

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
    """Quantities of the sources that the workspace holds, as forms of its rows.

    These are the contacts of the edges and, if the scene ``inserts``, of the corners with the
    walls, and places of all edges and corners. Without insertion the support is A1.
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
    found = {
        PLACES: CornerPositions(**(unknown | places)),
        FACE: ContactState(P.half_height + along_axis, _row("face_load"), along_face),
        SIDE: ContactState(
            places["left_behind_side"], _row("side_load"), places["left_along_axis"]
        ),
        FORCES: Motion(**forces),
    }
    return found if not inserts else found | {
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

    A missing quantity of a level of several is NOTHING, and so is one that is not known.
    """
    if source not in QUANTITIES[inserts]:
        return None
    mode = MODE if inserts else MODE._replace(edge=RIGHT_EDGE)
    found = python_of(level)(QUANTITIES[inserts][source], P, mode)
    return tuple(map(_as_form, found if isinstance(found, tuple) else (found,)))


def is_nothing(form: LinearForm) -> bool:
    """Return whether a level of several quantities does not have this one."""
    return form.tree == ("constant", NOTHING)
