"""Levels of events as sums of workspace lines, by symbolic tracing.

Input: an event function. Output: a ``Level`` of each of its quantities, which the kernels of
lane_events.py sum and bound. An event function is called once with symbols in place of numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from model.compile.kernels import inlined_kernel
from model.engine.series import Sum, as_sum, given, sum_of, symbols_of
from model.engine.series_layout import LINES, ORDER
from model.engine.series_rules import Absolute, Constant, Line, TaylorSeries, Unknown
from model.engine.workspace import LINE, MODE_LINE
from model.events.event_functions import ABSENT
from model.events.insertion import LEFT_WALL, RIGHT_SIDE, RIGHT_WALL
from model.events.sources import ContactState, CornerPositions
from model.events.table import CORNER, FACE, FORCES, PLACES, SIDE, Source
from model.physics.modes import CLOSED, Mode
from model.physics.motion import Motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.parameters import Constants


@dataclass(frozen=True, eq=False)
class Term:
    """Multiple of a line of the workspace, of its rate, or of the absolute value ``inside``."""

    factor: Constant
    line: int
    inside: "Level | None" = None
    is_rate: bool = False


@dataclass(frozen=True, eq=False)
class Level:
    """Quantity of an event: a constant and terms.

    Attributes:
        constant: ABSENT for a quantity that the event lacks.
        terms: multiples of lines, of their rates, and of absolute values.
    """

    constant: Constant
    terms: tuple[Term, ...] = ()

    @property
    def has_absolute(self) -> bool:
        """True if it contains an absolute value."""
        return any(each.inside is not None for each in self.terms)

    @property
    def has_rate(self) -> bool:
        """True if it contains a rate: it has a series, but no samples."""
        return any(each.is_rate for each in self.terms)


# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def constant_in(value, w, i):
    """Return a constant of lane ``i``; see ``Constant``."""
    if isinstance(value, float):
        return value
    how, of = value[0], value[1:]
    if how == "given":
        return w[of[0], i]
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
    """Return a level of lane ``i``, from the lines after the ``first``; ABSENT with a rate."""
    if level.has_rate:
        return ABSENT
    total = None if level.constant == 0.0 else constant_in(level.constant, w, i)
    for term in level.terms:
        if term.inside is None:
            value = w[first + term.line, i]
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
        if term.is_rate:
            following = w[first + LINES + term.line, i] if order < ORDER else 0.0
            value = (order + 1) * scale * following
        elif term.inside is None:
            value = scale * w[first + term.line, i]
        else:
            value = sign * coefficient_in(term.inside, order, first, scale, sign, w, i)
        total = _plus(total, term, value, w, i)
    return total


@inlined_kernel
def bound_in(level, first, scale, w, i):
    """Return a bound of a level's distance from the line through samples, from those of lines."""
    if level.has_rate:
        return 0.0
    total = 0.0
    for term in level.terms:
        if term.inside is None:
            bound = scale * w[first + term.line, i]
        else:
            bound = bound_in(term.inside, first, scale, w, i)
        total = total + abs(constant_in(term.factor, w, i)) * bound
    return total


# ------------------------------------------------------------------------------------------ tracing

_UNKNOWN = sum_of(Unknown())
_MODE_SYMBOLS: Any = Mode(*(given(MODE_LINE + n) for n in range(len(Mode._fields))))


def _line(name: str) -> Any:
    return sum_of(Line(LINE[name], is_rate=False))


def _rate(name: str) -> Any:
    return sum_of(Line(LINE[name], is_rate=True))


def _is(field: str, value: float) -> Any:
    """Return 1 where a field of the mode has a value, else 0."""
    return Sum(("==", getattr(_MODE_SYMBOLS, field).constant, float(value)), {})


@cache
def _quantities(inserts: bool, is_round: bool) -> dict[Source, Any]:
    """Return the quantities of every source that the workspace holds, as sums of its lines.

    The sources are the corner positions, the contacts of edges and corners and, if the scene
    ``inserts``, those with the walls.
    """
    places = {
        name: _rate(name.replace("rise", "y")) if name.endswith("_rise") else _line(name)
        for name in CornerPositions._fields
    }
    forces: dict[str, Any] = dict.fromkeys(Motion._fields, _UNKNOWN)
    sides = ("support", "face", "corner"), ("side", "side", "wall")
    for side, edge, corner in sides:
        friction = _line(f"{side}_friction")  # or the slip of a sliding contact
        forces |= {f"{side}_slip": friction, f"{side}_friction": friction}
        forces[f"{side}_load"] = _line(f"{edge}_load")
        if inserts or corner == "corner":
            loads = (_is(each, CLOSED) * _line(f"{each}_load") for each in (edge, corner))
            forces[f"{side}_load"] = sum(loads, as_sum(0.0))
    right, left = _is("edge", RIGHT_EDGE), _is("edge", LEFT_EDGE)
    along_face, along_axis, corner_x, corner_y = (
        right * places[f"right_{name}"] + left * places[f"left_{name}"]
        for name in ("along_face", "along_axis", "corner_x", "corner_y")
    )
    p = symbols_of(Constants)
    behind = p.half_height + along_axis
    if is_round:
        behind = _MODE_SYMBOLS.edge * places["tips_depth"]
    sources = {
        PLACES: CornerPositions(**places),
        FACE: ContactState(behind, _line("face_load"), along_face),
        CORNER: ContactState(
            -corner_y - _MODE_SYMBOLS.corner_offset, _line("corner_load"), corner_x
        ),
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
    return Level(found.constant, tuple(_term_of(*each) for each in found.terms.items()))


def _term_of(series: TaylorSeries, factor: Constant) -> Term:
    """Return a term of a level.

    Raises:
        ValueError: it is no line, no rate of one, and no absolute value of a sum of lines.
    """
    if isinstance(series, Line):
        return Term(factor, series.number, is_rate=series.is_rate)
    if isinstance(series, Absolute):
        inside = _level_of(Sum(series.of.constant, dict(series.of.terms)))
        if not (inside.has_absolute or inside.has_rate):
            return Term(factor, 0, inside)
    raise ValueError(f"a level contains the {series.rule} of event quantities, but must be linear")


def levels_of(
    source: Source, function: Callable[..., Any], inserts: bool, p: Constants
) -> tuple[Level, ...] | None:
    """Return the quantities of an event; None if the workspace does not hold its source.

    ``p`` are the ``symbols_of`` the part.
    """
    quantities = _quantities(inserts, p.is_round)
    if source not in quantities:
        return None
    found = function(quantities[source], p, _MODE_SYMBOLS)
    return tuple(map(_level_of, found if isinstance(found, tuple) else (found,)))
