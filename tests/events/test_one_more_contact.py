"""A contact is added by its law and its events alone, and both engines agree on it.

The contact is that of A1 with the right side face, which a part meets after falling in. Its law is
that of A2 with the left side face (``edge_on_side``). Here are the events that begin and end it,
and what follows them; no other code knows of it.
"""

import numpy as np
import pytest

from model import Batch, Outcome, Scene, Settings
from model.engines.batch.event_kernels import in_vector_kernels
from model.engines.batch.scheduling import POOL, integrate_all, new_many
from model.engines.queue import new_queue
from model.engines.record import EVENT_COUNT, MODE, REASON, STATE, TAU_ALIGN, TIME
from model.engines.results import RunResult
from model.engines.scalar.loop import TRACK_COLUMNS, integrate, new_single
from model.events import levels, transitions
from model.events.kernels import in_kernels
from model.events.modes import with_side
from model.events.outcomes import Reason
from model.events.table import EVENTS, LOAD, Event, Source, changed
from model.events.transitions import decided, edge_enters, touching
from model.physics.compiled import inlined_kernel, kernel
from model.physics.contacts import edge_on_side
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE
from model.physics.scenes import ALIGNMENT, CLOSED, OPEN, RELEASED, Mode

SIDE_EDGE = MODE + Mode._fields.index("side_edge")
_LEFT_SCENE, _BOTH_SIDES = int(Outcome.LEFT_SCENE), int(Reason.BOTH_SIDES)

# ------------------------------------------------------------------------- where its events apply


@inlined_kernel
def on_right_side(_p, mode):
    return mode.side != OPEN and mode.side_edge == RIGHT_EDGE


@inlined_kernel
def presses(_p, mode):
    return mode.side == CLOSED and mode.side_edge == RIGHT_EDGE


@inlined_kernel
def is_released(_p, mode):
    return mode.side == RELEASED and mode.side_edge == RIGHT_EDGE


@inlined_kernel
def right_edge_is_free(p, mode):
    return not (mode.edge == RIGHT_EDGE and mode.face != OPEN) and not on_right_side(p, mode)


@inlined_kernel
def left_edge_is_free(p, mode):
    return not (mode.edge == LEFT_EDGE and mode.face != OPEN) and not levels.on_left_side(p, mode)


@inlined_kernel
def right_corner_is_free(p, mode):
    return not (mode.edge == RIGHT_EDGE and mode.corner != OPEN) and not on_right_side(p, mode)


@inlined_kernel
def left_corner_is_free(p, mode):
    return not (mode.edge == LEFT_EDGE and mode.corner != OPEN) and not levels.on_left_side(p, mode)


@inlined_kernel
def nowhere(_p, _mode):
    return False


# ----------------------------------------------------------------------------- what follows them


@kernel
def right_edge_enters(time, q, p, mode, declared):
    """Begin the contact where A1 is least deep behind the right side face."""
    bottom, left, right, top = levels.edge_inside(RIGHT_EDGE, levels.outline(q, p), p)
    if right >= min(bottom, min(left, top)):
        return edge_enters(RIGHT_EDGE, time, q, p, mode, declared)
    if mode.side != OPEN:
        return mode, _LEFT_SCENE, _BOTH_SIDES
    state = touching(edge_on_side(RIGHT_EDGE, q, p), q, p)
    return decided(time, q, p, with_side(mode, RIGHT_EDGE, state), False, False)


@kernel
def left_edge_enters(time, q, p, mode, declared):
    """Leave the scene where A2 enters behind a side face while A1 is behind the other."""
    bottom, left, _, _ = levels.edge_inside(LEFT_EDGE, levels.outline(q, p), p)
    if mode.side != OPEN and left < bottom:
        return mode, _LEFT_SCENE, _BOTH_SIDES
    return edge_enters(LEFT_EDGE, time, q, p, mode, declared)


# ------------------------------------------------------------------------------------- the table

RIGHT_SIDE = Source(levels.side_touch, on_right_side)
TABLE = (
    *EVENTS,
    Event(
        "right_side_load", RIGHT_SIDE, ((presses, levels.load),), transitions.side_unloaded,
        kind=LOAD, force_on="side",
    ),
    Event("right_side_gap", RIGHT_SIDE, ((is_released, levels.depth),), transitions.side_opens),
    Event(
        "right_side_reload", RIGHT_SIDE, ((is_released, levels.missing_load),),
        transitions.side_reloaded, kind=LOAD,
    ),
    Event(
        "right_side_end", RIGHT_SIDE, ((on_right_side, levels.before_side_end),),
        transitions.side_ends,
    ),
)  # fmt: skip
for name, applies, level, follow in (
    ("right_edge_enters", right_edge_is_free, levels.right_edge_outside, right_edge_enters),
    ("left_edge_enters", left_edge_is_free, levels.left_edge_outside, left_edge_enters),
    (
        "right_corner_lands", right_corner_is_free, levels.right_corner_above,
        transitions.right_corner_lands,
    ),
    (
        "left_corner_lands", left_corner_is_free, levels.left_corner_above,
        transitions.left_corner_lands,
    ),
    # Runs go on in the slot, where the contact is met, for as long as a fall may take.
    ("corners_inside", nowhere, levels.corners_outside, transitions.inside),
):  # fmt: skip
    TABLE = changed(TABLE, name, level=((applies, level),), follow=follow)

SCENE = Scene("with the right side face", ALIGNMENT.contacts, TABLE)
SETS = 96


@pytest.fixture(scope="module")
def rows(device):
    """Random sets of which most align, shape (SETS, constants)."""
    rng = np.random.default_rng(1023)
    cases = [
        device.replace(
            half_height=rng.uniform(1.0, 2.0), inertia=rng.uniform(1.0, 4.0),
            tilt_damping=rng.uniform(0.5, 2.0), lateral_damping=rng.uniform(0.1, 0.6),
            press_force=rng.uniform(1.0, 5.0), tilt_stiffness=rng.uniform(5.0, 30.0),
            frequency=rng.uniform(0.3, 3.0), friction=rng.uniform(0.02, 0.1),
            initial_tilt=rng.uniform(0.0, 0.02), contact_damping=rng.uniform(0.5, 2.0),
            lateral_stiffness=rng.uniform(0.3, 2.0), rest_x=rng.uniform(-0.2, 0.4),
        )
        for _ in range(SETS)
    ]  # fmt: skip
    assert SETS <= POOL
    return Batch.stack(cases).constants(Settings().readings)


@pytest.fixture(scope="module")
def settings():
    return Settings(scene=SCENE, horizon=80.0, tolerance=1e-11, may_settle=False)


@pytest.fixture(scope="module")
def one_by_one(rows, settings):
    """Last record of every run by the reference engine."""
    found, track = [], np.empty((0, TRACK_COLUMNS))
    _, method, control = settings.for_kernels
    for row in rows:
        single = new_single(method)
        integrate(row, 1e-11, in_kernels(SCENE), method, control, track, single)
        found.append(single.runs[0].copy())
    return np.array(found)


@pytest.fixture(scope="module")
def together(rows, settings):
    """The same by the batch engine."""
    _, method, control = settings.for_kernels
    scene, results = in_vector_kernels(SCENE), np.empty((SETS, len(RunResult._fields)))
    many, queue = new_many(scene, False), new_queue(SETS, 1)
    integrate_all(rows, np.full(SETS, 1e-11), scene, method, control, queue, results, many)
    return many.runs[:SETS].copy()


def test_the_contact_is_met_and_ended(one_by_one):
    touched = one_by_one[:, SIDE_EDGE] == RIGHT_EDGE
    assert touched.sum() >= SETS // 2
    assert (one_by_one[touched, EVENT_COUNT] >= 3).all()
    is_open = one_by_one[touched, MODE + Mode._fields.index("side")] == OPEN
    assert 0 < is_open.sum() < touched.sum()


def test_both_engines_agree_on_the_contact(one_by_one, together):
    touched = one_by_one[:, SIDE_EDGE] == RIGHT_EDGE
    for column in (REASON, SIDE_EDGE):
        assert (one_by_one[:, column] == together[:, column]).all()
    assert together[:, TAU_ALIGN] == pytest.approx(one_by_one[:, TAU_ALIGN], abs=1e-7, nan_ok=True)
    assert together[touched, TIME] == pytest.approx(one_by_one[touched, TIME], abs=1e-6)
    # A slip that is zero at an event to rounding may count as one event, or as two.
    assert (one_by_one[touched, EVENT_COUNT] == together[touched, EVENT_COUNT]).mean() >= 0.95
    apart = np.abs(one_by_one - together)[touched, STATE : STATE + 6].max(axis=1)
    assert np.median(apart) < 1e-9
    assert apart.max() < 1e-6


def test_a_part_that_meets_the_missing_contact_leaves_the_alignment_scene(one_by_one, rows):
    inside = changed(EVENTS, "corners_inside", level=((nowhere, levels.corners_outside),))
    scene = Scene("without the right side face", ALIGNMENT.contacts, inside)
    settings = Settings(scene=scene, horizon=80.0, tolerance=1e-11, may_settle=False)
    without, method, control = settings.for_kernels
    single, track = new_single(method), np.empty((0, TRACK_COLUMNS))
    touched = np.flatnonzero(one_by_one[:, SIDE_EDGE] == RIGHT_EDGE)
    for row in touched[:10]:
        integrate(rows[row], 1e-11, without, method, control, track, single)
        assert single.runs[0, TIME] < one_by_one[row, TIME]
