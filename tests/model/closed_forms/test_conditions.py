"""Conditions on several quantities: met for an instant, at the start, or all at the same time.

The event location decides exactly, so that the outcome depends neither on steps nor on rounding.
"""

from math import cos, sin

import numpy as np
import pytest
from scipy.optimize import brentq

from model.events.event_functions import FLAT
from model.events.friction import decide_friction
from model.events.kernels import events_of, transition
from model.events.outcomes import Outcome, Reason
from model.events.table import CORNER_END
from model.events.transitions import CONTINUES
from model.physics.modes import CLOSED, OPEN, START, STICKING
from model.physics.notation import LEFT_EDGE, State
from vibralign import ALIGNMENT

FREE = START._replace(face=OPEN)
TOLERANCES = [1e-4, 1e-7, 1e-10, 1e-13]


@pytest.fixture(scope="module")
def bare(device):
    """The part without springs, dampers, press and excitation, except for the axial spring."""
    return device.replace(
        lateral_stiffness=0.0, tilt_stiffness=0.0, lateral_damping=0.0, axial_damping=0.0,
        tilt_damping=0.0, press_force=0.0, frequency=0.0, phase=0.0, rest_y=device.half_height,
    )  # fmt: skip


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("late", [0.1, 0.5, 0.9])
def test_a_part_that_flies_across_the_slot_falls_in_for_an_instant(
    stepped_run, bare, late, tolerance
):
    # Upright, it is over the slot for 2 (l - a) / speed: that is a hundredth of the flight. In
    # this window it comes down to the plane.
    speed, start = 40.0, 3.0
    wide = bare.slot_half_width - bare.half_width
    falls = (start - wide + late * 2.0 * wide) / speed
    # y = b + c cos τ - c sin τ / tan(falls): down to b at ``falls``.
    height = 0.05
    state = np.array([start, bare.half_height + height, 0.0, -speed, -height / np.tan(falls), 0.0])
    run = stepped_run(bare, state, FREE, horizon=1.0, tolerance=tolerance)
    assert run.outcome == Outcome.ALIGNED
    assert run.tau_align == pytest.approx(falls, abs=max(1e-2 * tolerance, 1e-12))


@pytest.mark.parametrize("tilt", [1e-13, 1e-10, 1e-6])
@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_part_that_comes_down_beside_the_slot_stands_on_its_edge(
    stepped_run, bare, tilt, tolerance
):
    # All of its bottom reaches the plane at once, or nearly so; no corner comes out of the slot.
    state = np.array([bare.half_width, bare.half_height + 0.1, tilt, 0.0, -1.0, 0.0])
    run = stepped_run(bare, state, FREE, horizon=0.2, tolerance=tolerance, until=lambda run: (
        run.steps[-1].end_mode.face == CLOSED
    ))  # fmt: skip
    assert run.outcome == CONTINUES
    assert run.impacts()


@pytest.mark.parametrize("side", ["edge", "corner"])
def test_a_flat_part_stands_on_its_edge(stepped_run, device, side):
    # Less than FLAT is flat, whichever way: rounding must not choose.
    tilt = -0.5 * FLAT if side == "edge" else -2.0 * FLAT
    run = stepped_run(device.replace(initial_tilt=tilt, misalignment=0.4), horizon=1e-3)
    mode = run.steps[0].mode
    assert (mode.face, mode.corner) == ((CLOSED, OPEN) if side == "edge" else (OPEN, CLOSED))


def over_the_slot(bare, **changes):
    """A flat start with A1 already past the corner B1."""
    middle = 0.5 * (bare.slot_half_width - bare.half_width)
    return bare.replace(initial_tilt=0.0, misalignment=middle, **changes)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_part_that_starts_over_the_slot_and_falls_aligns_at_once(stepped_run, bare, tolerance):
    # It falls by 1e-12 before the excitation lifts it: 950 periods pass in 2 π.
    start = over_the_slot(bare, press_force=0.045, frequency=950.0, phase=-3.179)
    run = stepped_run(start, horizon=1.0, tolerance=tolerance)
    assert (run.outcome, run.tau_align) == (Outcome.ALIGNED, 0.0)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_part_that_is_lifted_from_over_the_slot_aligns_on_its_return(
    stepped_run, bare, tolerance
):
    start = over_the_slot(bare, press_force=-0.1, frequency=0.5)
    run = stepped_run(start, horizon=10.0, tolerance=tolerance)

    def height(tau):  # y - b of y'' = b - y + 0.1 - sin 0.5 τ
        return 0.1 * (1.0 - cos(tau)) - (sin(0.5 * tau) - 0.5 * sin(tau)) / 0.75

    assert height(0.1) > 0.0
    assert run.outcome == Outcome.ALIGNED
    assert run.tau_align == pytest.approx(brentq(height, 0.1, 2.0), abs=10.0 * tolerance)


def test_a_corner_that_slides_into_the_slot_past_the_edge_aligns(device, constants):
    # X_B2 = -l to rounding, either side of it; B1 is about to meet the other wall.
    p = constants(device.replace(clearance=1e-9))
    tilt = 1e-5
    mode = FREE._replace(edge=LEFT_EDGE, corner=CLOSED, corner_offset=1e-3)
    for off in (-1e-16, 0.0, 1e-16):
        x = p.half_width * cos(tilt) - p.half_height * sin(tilt) - p.slot_half_width + off
        q = State(x, p.half_height - 2e-3, tilt, 1.0, -0.1, 0.0)
        after, outcome, reason = transition(
            events_of(ALIGNMENT.events), CORNER_END, 0.1, q, p, mode, ALIGNMENT.declared
        )
        assert (outcome, reason) == (Outcome.ALIGNED, Reason.NONE)
        assert after.dropped
        assert after.corner == OPEN


@pytest.mark.parametrize("pull", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("stiffness", [1e2, 1e7])
def test_an_unloaded_contact_sticks_only_if_nothing_pulls(device, constants, pull, stiffness):
    # At rest, just touching: a lateral spring pulls, and friction has nothing to hold it with.
    p = constants(device.replace(
        contact_stiffness=stiffness, rest_x=device.misalignment + pull, lateral_stiffness=10.0
    ))  # fmt: skip
    q = State(device.misalignment, p.half_height, 0.0, 0.0, 0.0, 0.0)
    mode, possible = decide_friction(0.0, q, p, START, True, True)
    assert possible
    assert mode.support_slip == (np.sign(pull) if pull else STICKING)


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(
    ("side", "reason"), [(1, Reason.MOVED_AWAY), (-1, Reason.OVERSHOT)], ids=["right", "left"]
)
def test_a_part_that_comes_down_beside_the_slot_has_left_the_scene(
    stepped_run, bare, side, reason, tolerance
):
    # All of it is beyond the edge, tilted so that the corner at the slot is the lower one.
    x = side * (bare.slot_half_width + 2.0 * bare.half_width)
    state = np.array([x, bare.half_height + 0.1, 0.05 * side, 0.0, -1.0, 0.0])
    run = stepped_run(bare, state, FREE, horizon=1.0, tolerance=tolerance)
    assert (run.outcome, run.reason) == (Outcome.LEFT_SCENE, reason)
