"""Sources of event functions: the quantities that each takes, and the modes in which they exist.

A source gives positions of edges and corners, or depth, load and place of one contact, or the
forces.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from model.compile.kernels import inlined_kernel
from model.physics.contacts import (
    contact_load,
    corner_on_flat,
    corner_on_wall,
    edge_on_side,
    support_on_face,
)
from model.physics.geometry import bottom_corner, edge_place, tips_depth
from model.physics.modes import OPEN
from model.physics.motion import is_beside, is_supported, motion, never_sticks
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE


def on_both_sides(function: Callable[..., Any]) -> tuple[Any, Any]:
    """Make the kernels that call ``function`` with RIGHT_EDGE and with LEFT_EDGE in front."""

    def on(edge: float) -> Any:
        @inlined_kernel
        def of_edge(*arguments):
            return function(edge, *arguments)

        return of_edge

    return on(RIGHT_EDGE), on(LEFT_EDGE)


class CornerPositions(NamedTuple):
    """Positions of the edges in the frame of the part, and of the bottom corners in the base's.

    ``along_face`` and ``along_axis`` as in ``EdgePlace``, the depth of A2 behind the left side in
    the selected variant, (X, Y) of the corners, the tilt, and dY/dτ of the corners. ``tips_depth``
    is that of a round part's tips over A1, and its negative that of the tips over A2.
    """

    right_along_face: float
    right_along_axis: float
    left_along_face: float
    left_along_axis: float
    left_behind_side: float
    right_corner_x: float
    right_corner_y: float
    left_corner_x: float
    left_corner_y: float
    tilt: float
    right_corner_rise: float
    left_corner_rise: float
    tips_depth: float


class ContactState(NamedTuple):
    """One contact: its depth, its load, and its place along the touched face or the base."""

    depth: float
    load: float
    along: float


@inlined_kernel
def corner_positions(q, p):
    """The ``CornerPositions`` for the state ``q``."""
    right = edge_place(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, p)
    behind_side = left.along_face + p.half_width
    if p.printed_side_gap != 0.0:
        behind_side = edge_on_side(LEFT_EDGE, q, p).depth
    right_x, right_y = bottom_corner(RIGHT_EDGE, q.x, q.y, q.tilt, p)
    left_x, left_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
    return CornerPositions(
        right.along_face, right.along_axis, left.along_face, left.along_axis, behind_side,
        right_x, right_y, left_x, left_y, q.tilt,
        q.y_rate + q.tilt_rate * (right_x - q.x), q.y_rate + q.tilt_rate * (left_x - q.x),
        tips_depth(q.x, q.y, q.tilt, p) if p.is_round else 0.0,
    )  # fmt: skip


@inlined_kernel
def places(_time, q, p, _mode):
    """The ``CornerPositions``, as a source of event functions."""
    return corner_positions(q, p)


@inlined_kernel
def face_state(_time, q, p, mode):
    """``ContactState`` of the supporting edge, or of a round part's tips, on the bottom face.

    Tips end where the edge on their side does: ``along`` is the edge's.
    """
    face = support_on_face(mode.edge, q, p)
    load = contact_load(face.depth, face.closing_rate, q, p)
    if p.is_round:
        edge = edge_place(mode.edge, q.x, q.y, q.tilt, p)
        return ContactState(mode.edge * tips_depth(q.x, q.y, q.tilt, p), load, edge.along_face)
    return ContactState(face.depth, load, face.along)


@inlined_kernel
def _side_state(edge, _time, q, p, _mode):
    side = edge_on_side(edge, q, p)
    load = contact_load(side.depth, side.closing_rate, q, p)
    return ContactState(side.depth, load, edge_place(edge, q.x, q.y, q.tilt, p).along_axis)


# ``ContactState`` of A1 on the right side face, of A2 on the left one.
right_side_state, side_state = on_both_sides(_side_state)


@inlined_kernel
def corner_state(_time, q, p, mode):
    """``ContactState`` of the corner on the supporting side on the flat base."""
    corner = corner_on_flat(mode.edge, q, p)
    depth = corner.depth - mode.corner_offset
    load = contact_load(depth, corner.closing_rate, q, p)
    return ContactState(depth, load, -corner.along)


@inlined_kernel
def _wall_state(side, _time, q, p, _mode):
    corner = corner_on_wall(side, q, p)
    load = contact_load(corner.depth, corner.closing_rate, q, p)
    return ContactState(corner.depth, load, side * corner.along)


# ``ContactState`` of B1 on the right wall, of B2 on the left one.
right_wall_state, left_wall_state = on_both_sides(_wall_state)


# ------------------------------------------------------------- modes in which the quantities exist


@inlined_kernel
def always(_p, _mode):
    """Return True: positions exist in every mode."""
    return True


@inlined_kernel
def on_face(_p, mode):
    """Return whether the bottom face and an edge overlap."""
    return mode.face != OPEN and not mode.in_slot


@inlined_kernel
def on_left_side(_p, mode):
    """Return whether the left side face and A2 overlap."""
    return mode.side != OPEN


@inlined_kernel
def on_corner(_p, mode):
    """Return whether a bottom corner and the flat base overlap."""
    return mode.corner != OPEN and not mode.in_slot


@inlined_kernel
def rubs(p, mode):
    """Return whether a contact presses, and friction states may change."""
    return not never_sticks(p) and (is_supported(mode) or is_beside(mode))


@inlined_kernel
def forces(time, q, p, mode):
    """The ``Motion``, for slips, loads and friction forces."""
    return motion(time, q, p, mode)
