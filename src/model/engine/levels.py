"""Levels of events as sums of workspace lines, by symbolic tracing.

Input: an event function. Output: a ``Level`` of each of its quantities, which the kernels of
lane_events.py sum and bound. An event function is called once with symbols in place of numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from model.compile.kernels import inlined_kernel
from model.compile.vector_code import WIDTH
from model.engine.series import SYMBOLS, Constant, Sum, TaylorSeries, as_sum, given, sum_of
from model.engine.workspace import LINE, MODE_LINE
from model.events.event_functions import ABSENT
from model.events.insertion import LEFT_WALL, RIGHT_SIDE, RIGHT_WALL
from model.events.sources import ContactState, CornerPositions
from model.events.table import FACE, FORCES, PLACES, SIDE, Source
from model.physics.modes import CLOSED, Mode
from model.physics.motion import Motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Constants


@dataclass(frozen=True, eq=False)
class Term:
    """Multiple of a line of the workspace, or of the absolute value ``inside``."""

    factor: Constant
    line: int
    inside: "Level | None" = None


@dataclass(frozen=True, eq=False)
class Level:
    """Quantity of an event: a constant and terms.

    Attributes:
        constant: ABSENT for a quantity that the event lacks, or that no line holds.
        terms: multiples of lines and of absolute values.
        is_known: False for a quantity that no line holds, or that is not linear in the lines.
    """

    constant: Constant
    terms: tuple[Term, ...] = ()
    is_known: bool = True

    @property
    def has_absolute(self) -> bool:
        """True if it contains an absolute value."""
        return any(each.inside is not None for each in self.terms)


# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def constant_in(value, w, i):
    """Return a constant of lane ``i``; see ``Constant``."""
    if isinstance(value, float):
        return value
    how, of = value[0], value[1:]
    if how == "given":
        return w[of[0] * WIDTH + i]
    one, other = constant_in(of[0], w, i), constant_in(of[1], w, i)
    if how == "+":
        return one + other
    if how == "*":
        return one * other
    return 1.0 if one == other else 0.0


@inlined_kernel
def _plus(total, term, value, w, i):
    """Return ``total``, None for nothing, plus the term with this value."""
    if term.factor == 1.0:
        return value if total is None else total + value
    if term.factor == -1.0:
        return -value if total is None else total - value
    product = constant_in(term.factor, w, i) * value
    return product if total is None else total + product


@inlined_kernel
def level_in(level, first, w, i):
    """Return a level of lane ``i``, from the lines after the ``first``."""
    total = None if level.constant == 0.0 else constant_in(level.constant, w, i)
    for term in level.terms:
        if term.inside is None:
            value = w[(first + term.line) * WIDTH + i]
        else:
            value = abs(level_in(term.inside, first, w, i))
        total = _plus(total, term, value, w, i)
    return total


@inlined_kernel
def coefficient_in(level, order, first, scale, sign, w, i):
    """Return the coefficient of an order of a level's series, from the lines after the ``first``.

    ``scale`` is the power of the step's length, and ``sign`` that of the absolute value's argument.
    """
    total = constant_in(level.constant, w, i) if order == 0 else 0.0
    for term in level.terms:
        if term.inside is None:
            value = scale * w[(first + term.line) * WIDTH + i]
        else:
            value = sign * coefficient_in(term.inside, order, first, scale, sign, w, i)
        total = _plus(total, term, value, w, i)
    return total


@inlined_kernel
def bound_in(level, first, scale, w, i):
    """Return a bound of a level's distance from the line through samples, from those of lines."""
    total = 0.0
    for term in level.terms:
        if term.inside is None:
            bound = scale * w[(first + term.line) * WIDTH + i]
        else:
            bound = bound_in(term.inside, first, scale, w, i)
        total = total + abs(constant_in(term.factor, w, i)) * bound
    return total


# ------------------------------------------------------------------------------------------ tracing

_UNKNOWN = sum_of(TaylorSeries("unknown", ()))
_MODE_SYMBOLS: Any = Mode(*(given(MODE_LINE + n) for n in range(len(Mode._fields))))


def _line(name: str) -> Any:
    return sum_of(TaylorSeries("line", (LINE[name],)))


def _is(field: str, value: float) -> Any:
    """Return 1 where a field of the mode has a value, else 0."""
    place = getattr(_MODE_SYMBOLS, field).constant
    return Sum(("==", place, float(value)), {})


@cache
def _quantities(inserts: bool, is_round: bool) -> dict[Source, Any]:
    """Return the quantities of every source that the workspace holds, as sums of its lines.

    The sources are the corner positions, the contacts of the edges and, if the scene ``inserts``,
    of the corners with the walls. Without insertion the support is A1.
    """
    places = {name: _line(name) for name in CornerPositions._fields if not name.endswith("_rise")}
    unknown = dict.fromkeys(CornerPositions._fields, _UNKNOWN)
    forces: dict[str, Any] = dict.fromkeys(Motion._fields, _UNKNOWN)
    sides = ("support", "face", "corner"), ("side", "side", "wall")
    for place, edge, corner in sides:
        friction = _line(f"{place}_friction")  # or the slip of a sliding contact
        forces |= {f"{place}_slip": friction, f"{place}_friction": friction}
        forces[f"{place}_load"] = _line(f"{edge}_load")
        if inserts:
            loads = (_is(each, CLOSED) * _line(f"{each}_load") for each in (edge, corner))
            forces[f"{place}_load"] = sum(loads, as_sum(0.0))
    along_face, along_axis = places["right_along_face"], places["right_along_axis"]
    if inserts:
        right, left = _is("edge", RIGHT_EDGE), _is("edge", LEFT_EDGE)
        along_face = right * along_face + left * places["left_along_face"]
        along_axis = right * along_axis + left * places["left_along_axis"]
    p, behind = SYMBOLS, SYMBOLS.half_height + along_axis
    if is_round:
        behind = (_MODE_SYMBOLS.edge if inserts else RIGHT_EDGE) * places["tips_depth"]
    sources = {
        PLACES: CornerPositions(**(unknown | places)),
        FACE: ContactState(behind, _line("face_load"), along_face),
        SIDE: ContactState(
            places["left_behind_side"], _line("side_load"), places["left_along_axis"]
        ),
        FORCES: Motion(**forces),
    }
    return sources if not inserts else sources | {
        RIGHT_SIDE: ContactState(
            p.half_width - places["right_along_face"], _line("face_load"),
            places["right_along_axis"],
        ),
        RIGHT_WALL: ContactState(
            places["right_corner_x"] - p.slot_half_width, _line("corner_load"),
            places["right_corner_y"],
        ),
        LEFT_WALL: ContactState(
            -places["left_corner_x"] - p.slot_half_width, _line("wall_load"),
            places["left_corner_y"],
        ),
    }  # fmt: skip


def _level_of(total: Sum | float) -> Level:
    """Return a sum as a ``Level``."""
    found = as_sum(total)
    terms = [_term_of(series, factor) for series, factor in found.terms.items()]
    if None in terms:
        return Level(ABSENT, is_known=False)
    return Level(found.constant, tuple(terms))  # type: ignore[arg-type]


def _term_of(series: TaylorSeries, factor: Constant) -> Term | None:
    """Return a term of a level; None unless it is a line, or the absolute value of such a sum."""
    if series.rule == "line":
        return Term(factor, series.operands[0])
    if series.rule == "absolute":
        (argument,) = series.operands
        inside = _level_of(Sum(argument.operands[0], dict(argument.operands[1])))
        return Term(factor, 0, inside) if inside.is_known and not inside.has_absolute else None
    return None


def levels_of(
    source: Source, function: Callable[..., Any], inserts: bool, constants: type[Constants]
) -> tuple[Level, ...] | None:
    """Return the quantities of an event; None if the workspace does not hold its source."""
    quantities = _quantities(inserts, constants.is_round)
    if source not in quantities:
        return None
    mode = _MODE_SYMBOLS if inserts else _MODE_SYMBOLS._replace(edge=RIGHT_EDGE)
    found = function(quantities[source], constants(*SYMBOLS), mode)
    return tuple(map(_level_of, found if isinstance(found, tuple) else (found,)))
