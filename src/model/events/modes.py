"""Modes derived from another by a change of one contact."""

from typing import Any

from model.compile.jit import kernel
from model.compile.source import defined
from model.physics.scenes import CLOSED, OPEN, Mode


def _changing(arguments: str, **changes: str) -> Any:
    """Make the kernel (mode, ``arguments``) of the mode with other fields, given as expressions."""
    fields = ", ".join(changes.get(name, f"mode.{name}") for name in Mode._fields)
    code = f"def changed(mode{arguments}):\n    return Mode({fields})\n"
    return kernel(defined("changed", code, {"Mode": Mode, "OPEN": OPEN, "CLOSED": CLOSED}))


# (mode, edge, state): with the normal state of an edge on the bottom face, or of A1 on the right
# side face.
with_face = _changing(", edge, state", edge="edge", face="state")
# (mode, edge, state, offset): with the normal state of the corner on the side of an edge.
with_corner = _changing(
    ", edge, state, offset", edge="edge", corner="state", corner_offset="offset"
)
# (mode, in_slot): with the support on the right side of the slot or, without contact, on its edges.
with_support = _changing(", in_slot", face="OPEN", corner="OPEN", in_slot="in_slot")
# (mode, state): with the normal state of A2 on the left side face, of B2 on the left wall.
with_side = _changing(", state", side="state")
with_wall = _changing(", state", wall="state")
# (mode, support_slip, side_slip): with other friction states.
with_friction = _changing(
    ", support_slip, side_slip", support_slip="support_slip", side_slip="side_slip"
)
# (mode): of a part that has lost its contact past the corner B1, or has all corners in the slot.
with_drop = _changing("", face="OPEN", dropped="True")
with_corners_inside = _changing("", corners_inside="True")
# (mode): with the slips taken at contacts that press: the same ones if possible.
with_slip_place = _changing(
    "",
    slip_at_corner="mode.corner == CLOSED and (mode.slip_at_corner or mode.face != CLOSED)",
    slip_at_wall="mode.wall == CLOSED and (mode.slip_at_wall or mode.side != CLOSED)",
)
