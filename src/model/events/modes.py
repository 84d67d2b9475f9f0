"""Modes derived from another by a change of one contact."""

from model.physics.compiled import kernel
from model.physics.scenes import CLOSED, OPEN, Mode


@kernel
def with_face(mode, edge, state):
    """Return the mode with the normal state ``state`` of ``edge`` on the bottom face."""
    return Mode(
        edge, state, mode.corner, mode.corner_offset, mode.slip_at_corner, mode.support_slip,
        mode.side, mode.side_slip, mode.dropped, mode.side_edge,
    )  # fmt: skip


@kernel
def with_corner(mode, edge, state, offset):
    """Return the mode with the normal state ``state`` of the corner on the side of ``edge``."""
    return Mode(
        edge, mode.face, state, offset, mode.slip_at_corner, mode.support_slip, mode.side,
        mode.side_slip, mode.dropped, mode.side_edge,
    )  # fmt: skip


@kernel
def with_side(mode, edge, state):
    """Return the mode with the normal state ``state`` of ``edge`` on its side face."""
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, mode.slip_at_corner,
        mode.support_slip, state, mode.side_slip, mode.dropped, edge,
    )  # fmt: skip


@kernel
def with_friction(mode, support_slip, side_slip):
    """Return the mode with other friction states."""
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, mode.slip_at_corner, support_slip,
        mode.side, side_slip, mode.dropped, mode.side_edge,
    )  # fmt: skip


@kernel
def with_drop(mode):
    """Return the mode of a part that has lost its contact past the corner B1."""
    return Mode(
        mode.edge, OPEN, mode.corner, mode.corner_offset, mode.slip_at_corner, mode.support_slip,
        mode.side, mode.side_slip, True, mode.side_edge,
    )  # fmt: skip


@kernel
def with_slip_place(mode):
    """Return the mode whose slip is taken at a contact that presses: the same one if possible."""
    at_corner = mode.corner == CLOSED and (mode.slip_at_corner or mode.face != CLOSED)
    return Mode(
        mode.edge, mode.face, mode.corner, mode.corner_offset, at_corner, mode.support_slip,
        mode.side, mode.side_slip, mode.dropped, mode.side_edge,
    )  # fmt: skip
