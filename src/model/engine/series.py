"""The motion as Taylor series in time, traced from the equations of motion.

Input: a kind of mode (mode_kinds.py). Output: its ``Recurrences``, which series_layout.py places in
memory and series_code.py writes as code. ``motion`` and the corner positions are called once with
symbols in place of numbers. They return sums of Taylor series, each with a constant factor. The
next coefficient of a series follows from the known ones: it is a state (by its rate), sine or
cosine of an angle, a product, a quotient, a root, a sum, or the rate of another series. Recurrences
as in Moore, Interval Analysis (1966), ch. 11, and Jorba and Zou, Experimental Mathematics 14 (2005)
99-117.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from model.compile.kernels import Symbol, python_of
from model.engine.mode_kinds import SIDE_CONTACTS, ModeKind, mode_of_kind
from model.engine.series_rules import (
    Absolute,
    Constant,
    Cosine,
    Lack,
    Quotient,
    Rate,
    Root,
    Sine,
    StateVariable,
    SumSeries,
    TaylorSeries,
    Time,
    product,
)
from model.events.sources import corner_positions
from model.physics.contacts import (
    Contact,
    contact_load,
    corner_on_flat,
    corner_on_wall,
    dot,
    edge_on_face,
    edge_on_side,
    support_on_face,
    tips_on_face,
)
from model.physics.forces import lack_of_press
from model.physics.modes import Mode
from model.physics.motion import corner_share, motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import Constants
from model.physics.trigonometry import sine_cosine, square_root
from model.physics.variants import SWITCHES, Variants

# Lanes hold the first fields of ``Constants``: all that select no variant of the equations. The
# signs of the slips, and the depth of a corner when it began to press, follow.
LANE_CONSTANTS = len(Constants._fields) - len(SWITCHES)
SUPPORT_SIGN, SIDE_SIGN, CORNER_OFFSET = range(LANE_CONSTANTS, LANE_CONSTANTS + 3)
GIVEN = LANE_CONSTANTS + 3
CONSISTENT = Variants().switches


def _sum(a: Constant, b: Constant) -> Constant:
    if isinstance(a, float) and isinstance(b, float):
        return a + b
    if a == 0.0 or b == 0.0:
        return b if a == 0.0 else a
    return ("+", a, b)


def _product(a: Constant, b: Constant) -> Constant:
    if isinstance(b, float):
        a, b = b, a
    if isinstance(a, float):
        if isinstance(b, float):
            return a * b
        if a in (0.0, 1.0):
            return b if a else 0.0
        if b[0] == "*" and isinstance(b[1], float):
            return _product(a * b[1], b[2])
    return ("*", a, b)


def _inverse(a: Constant) -> Constant:
    return 1.0 / a if isinstance(a, float) else ("/", 1.0, a)


_CONTACTS = tuple(
    map(python_of, (edge_on_face, edge_on_side, corner_on_flat, corner_on_wall))
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Sum(Symbol):
    """Sum of a constant and of series, each with a constant factor.

    ``multiple`` = (factor, origin) where this sum is a multiple of another one: products with
    either then share one series.
    """

    constant: Constant
    terms: dict[TaylorSeries, Constant]
    multiple: "tuple[Constant, Sum] | None" = None

    def rule_of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the replacement of a function in a trace, or the function itself.

        Sine, cosine and square root become series. The closing rate and slip of a contact become
        rates of its depth and place. An edge and a corner that share friction are known to press.
        """
        if function is python_of(sine_cosine):
            return _sine_cosine
        if function is python_of(square_root):
            return _square_root
        if function is python_of(lack_of_press):
            return lambda _time, _p: sum_of(LACK_OF_PRESS)
        if function is python_of(tips_on_face):
            return _tips_with_rates
        if function is python_of(corner_share):
            return _share
        if function in _CONTACTS:
            return lambda *arguments: _with_rates(function(*arguments))
        return function

    def __add__(self, other: "Sum | float") -> "Sum":
        other = as_sum(other)
        terms = dict(self.terms)
        for series, factor in other.terms.items():
            terms[series] = _sum(terms.get(series, 0.0), factor)
        kept = {series: factor for series, factor in terms.items() if factor != 0.0}
        return Sum(_sum(self.constant, other.constant), kept)

    def times(self, factor: Constant) -> "Sum":
        """Return this sum times a constant."""
        if factor == 0.0:
            return Sum(0.0, {})
        if factor == 1.0:
            return self
        of, origin = self.multiple or (1.0, self)
        terms = {series: _product(factor, each) for series, each in self.terms.items()}
        return Sum(_product(factor, self.constant), terms, (_product(factor, of), origin))

    def __mul__(self, other: "Sum | float") -> "Sum":
        other = as_sum(other)
        if not other.terms:
            return self.times(other.constant)
        if not self.terms:
            return other.times(self.constant)
        (a, f, one), (b, g, another) = self._as_multiple(), other._as_multiple()
        squared = Sum(_product(a, b), {product(one, another): _product(f, g)})
        return squared + Sum(0.0, {another: _product(a, g)}) + Sum(0.0, {one: _product(b, f)})

    def _as_multiple(self) -> tuple[Constant, Constant, TaylorSeries]:
        """Return (constant, factor, series): this sum as a constant and a multiple of a series."""
        if len(self.terms) == 1:
            ((series, factor),) = self.terms.items()
            return self.constant, factor, series
        factor, origin = self.multiple or (1.0, self)
        return 0.0, factor, origin.as_series()

    def as_series(self) -> SumSeries:
        """Return this sum as a series of its own."""
        return SumSeries(self.constant, tuple(self.terms.items()))

    def __truediv__(self, other: "Sum | float") -> "Sum":
        other = as_sum(other)
        if not other.terms:
            return self.times(_inverse(other.constant))
        return Sum(0.0, {Quotient(self.as_series(), other.as_series()): 1.0})

    def __neg__(self) -> "Sum":
        return self.times(-1.0)

    def __sub__(self, other: "Sum | float") -> "Sum":
        return self + -as_sum(other)

    def __rsub__(self, other: float) -> "Sum":
        return as_sum(other) - self

    def __rtruediv__(self, other: float) -> "Sum":
        return as_sum(other) / self

    def __abs__(self) -> "Sum":
        return sum_of(Absolute(self.as_series()))

    __radd__, __rmul__ = __add__, __mul__


def as_sum(value: Sum | float) -> Sum:
    """Return a sum, or a number as one."""
    return value if isinstance(value, Sum) else Sum(float(value), {})


def given(line: int) -> Any:
    """Return the constant in a line of the workspace."""
    return Sum(("given", line), {})


def sum_of(series: TaylorSeries) -> Any:
    """Return the sum of one series."""
    return Sum(0.0, {series: 1.0})


STATES: tuple[TaylorSeries, ...] = tuple(map(StateVariable, range(len(State._fields))))
LACK_OF_PRESS = Lack()


def _with_rates(contact: Contact) -> Contact:
    """Return the contact with closing rate and slip as rates of its depth and place."""
    depth, closing_rate = _with_rate(contact.depth)
    _, receding = _with_rate(contact.along)
    return contact._replace(depth=depth, closing_rate=closing_rate, slip=-receding)


def _with_rate(value: Any) -> tuple[Any, Any]:
    """Return a sum, as a series of its own and a constant, and its rate."""
    series = SumSeries(0.0, tuple(value.terms.items()))
    return Sum(value.constant, {series: 1.0}), sum_of(Rate(series))


def _tips_with_rates(side: float, q: State, p: Constants) -> Contact:
    """Return the contact of tips, with its closing rate and the drift of its slip as rates.

    The slip is the row times the rates of the state, so its drift is the row's rate times them.
    """
    contact = python_of(tips_on_face)(side, q, p)
    depth, closing_rate = _with_rate(contact.depth)
    rows: Any = tuple(_with_rate(each) for each in contact.slip_row)
    row, turning = tuple(each for each, _ in rows), tuple(rate for _, rate in rows)
    slip, drift = (dot(each, q.x_rate, q.y_rate, q.tilt_rate) for each in (row, turning))
    return contact._replace(
        depth=depth, closing_rate=closing_rate, tangent=row, slip_row=row, slip=slip,
        slip_drift=drift,
    )  # fmt: skip


def _square_root(value: Sum) -> Sum:
    return sum_of(Root(value.as_series()))


def _sine_cosine(angle: Sum) -> tuple[Sum, Sum]:
    of = angle.constant, tuple(angle.terms.items())
    return sum_of(Sine(*of)), sum_of(Cosine(*of))


def _share(load: Sum, load_of_edge: Sum | float) -> Sum | float:
    return load / (load + load_of_edge) if isinstance(load_of_edge, Sum) else 1.0


class EventQuantities(NamedTuple):
    """Quantities from which the levels of events are computed.

    Places as in ``CornerPositions``; for either side the loads of its edge and of its corner, and
    the slip or, while the contact sticks, the friction force. Only the insertion scene has loads of
    walls, and only round parts have tips.
    """

    right_along_face: Any
    right_along_axis: Any
    left_along_face: Any
    left_along_axis: Any
    left_behind_side: Any
    right_corner_x: Any
    right_corner_y: Any
    left_corner_x: Any
    left_corner_y: Any
    face_load: Any
    support_friction: Any
    side_load: Any
    side_friction: Any
    corner_load: Any
    wall_load: Any
    tips_depth: Any


class Recurrences(NamedTuple):
    """The series of one kind of mode: accelerations (x, y, tilt), and all ``EventQuantities``."""

    accelerations: tuple[Sum, Sum, Sum]
    quantities: tuple[Sum, ...]


def symbols_of(constants: type[Constants], switches: tuple[float, ...] = CONSISTENT) -> Any:
    """Return the constants of a lane, for tracing: of a plane part or a round one, in a variant."""
    return constants(*map(given, range(LANE_CONSTANTS)), *switches)


def on_flat(q: State, p: Constants, mode: Mode) -> Contact:
    """Return the contact of the supporting corner with the flat base, as deep as it presses."""
    contact = corner_on_flat(mode.edge, q, p)
    return contact._replace(depth=contact.depth - mode.corner_offset)


def _load(contact: Contact, q: State, p: Constants) -> Any:
    return contact_load(contact.depth, contact.closing_rate, q, p)


def recurrences(
    kind: ModeKind,
    inserts: bool = False,
    constants: type[Constants] = Constants,
    switches: tuple[float, ...] = CONSISTENT,
) -> Recurrences:
    """Return the ``Recurrences`` of a kind of mode, with the loads of walls if it ``inserts``.

    ``constants`` is the class for a plane or a round part, and ``switches`` select the variant of
    the equations. They are the same for open and released contacts.
    """
    p, q = symbols_of(constants, switches), State(*map(sum_of, STATES))
    mode = mode_of_kind(kind, (given(SUPPORT_SIGN), given(SIDE_SIGN)), given(CORNER_OFFSET))
    at = motion(sum_of(Time()), q, p, mode)
    edge = edge_on_side(RIGHT_EDGE, q, p) if mode.in_slot else support_on_face(mode.edge, q, p)
    left_edge = edge_on_side(LEFT_EDGE, q, p)
    corner = corner_on_wall(RIGHT_EDGE, q, p) if mode.in_slot else on_flat(q, p, mode)
    left_corner = corner_on_wall(LEFT_EDGE, q, p)
    support, side = SIDE_CONTACTS[kind.support], SIDE_CONTACTS[kind.side]
    support_slip = (corner if support.slip_at_corner else edge).slip
    side_slip = (left_corner if side.slip_at_corner else left_edge).slip
    places = corner_positions(q, p)._asdict()
    quantities = EventQuantities(
        **{name: place for name, place in places.items() if name in EventQuantities._fields},
        face_load=_load(edge, q, p),
        support_friction=at.support_friction if support.sticks else support_slip,
        side_load=_load(left_edge, q, p),
        side_friction=at.side_friction if side.sticks else side_slip,
        corner_load=_load(corner, q, p),
        wall_load=_load(left_corner, q, p) if inserts else 0.0,
    )
    accelerations = as_sum(at.x), as_sum(at.y), as_sum(at.tilt)
    return Recurrences(accelerations, tuple(map(as_sum, quantities)))
