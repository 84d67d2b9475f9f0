"""The events of a round part in a round hole: those of a plane one, and tips that meet its face.

The bottom face of a round part rests on the tips of the crescent by which it covers the base; only
its side meets an edge. Where tips press, and where they end, the physics and the events of the face
know (``support_on_face``). All other contacts lie in the plane of symmetry, as of a plane part.
"""

from dataclasses import replace
from functools import cache

from model.compile.kernels import inlined_kernel
from model.events import event_functions as functions
from model.events import transitions
from model.events.table import (
    PLACES,
    START_TOLERANCE,
    Event,
    Table,
    left_edge_is_free,
    right_corner_is_free,
    right_edge_is_free,
)

RIGHT_TIPS, LEFT_TIPS = "right_tips_enter", "left_tips_enter"


@inlined_kernel
def _right_side_is_free(p, mode):
    return right_edge_is_free(p, mode) and (mode.dropped or right_corner_is_free(p, mode))


_ENTERING = {
    "right_edge_enters": (
        (_right_side_is_free, functions.right_edge_off_side),
        Event(
            RIGHT_TIPS, PLACES, ((right_edge_is_free, functions.right_tips_outside),),
            transitions.right_tips_enter,
        ),
    ),
    "left_edge_enters": (
        (left_edge_is_free, functions.left_edge_off_side),
        Event(
            LEFT_TIPS, PLACES, ((left_edge_is_free, functions.left_tips_outside),),
            transitions.left_tips_enter, start=-START_TOLERANCE,
        ),
    ),
}  # fmt: skip
"""For edges that enter a part: where they enter a round one, and the event of the tips over it."""


def _with_tips(each: Event) -> Table:
    """Return the events of a round part in place of one of a plane part."""
    if each.name not in _ENTERING:
        return (each,)
    case, tips = _ENTERING[each.name]
    return replace(each, function=(case,)), tips


@cache
def with_tips(table: Table) -> Table:
    """Return the table of a scene, for round parts."""
    return tuple(event for each in table for event in _with_tips(each))
