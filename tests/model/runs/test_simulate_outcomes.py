"""Ends of runs: each outcome and reason from a device made for it."""

from math import pi

import numpy as np
import pytest

from vibralign import (
    Outcome,
    Parameters,
    Reason,
    Variants,
    align,
    simulate,
)


def ended(run):
    return run.outcome, run.reason


# ------------------------------------------------------------------------------------------ aligned


@pytest.mark.parametrize("tilt", [0.0, 0.001, 0.01])
def test_a_part_over_the_slot_is_aligned_at_once(device, tilt):
    # misalignment < clearance * half_width: the right corner is left of A1 at the start, since
    # tilt moves it by no more than b tan φ = 0.041, against a gap of 0.047.
    p = device.replace(misalignment=0.5 * device.clearance * device.half_width, initial_tilt=tilt)
    run = simulate(p)
    assert run.outcome is Outcome.ALIGNED
    assert run.tau_align == 0.0


def test_a_part_just_beside_the_slot_is_not(device):
    p = device.replace(misalignment=1.001 * device.clearance * device.half_width)
    run = simulate(p)
    assert run.outcome is Outcome.ALIGNED
    assert run.tau_align > 0.01


def test_a_part_over_the_slot_tilted_the_other_way_has_to_fall_first(device):
    # φ < 0: the left corner is up; it must come down before the part counts as aligned.
    run = simulate(device.replace(misalignment=0.05, initial_tilt=-0.02))
    assert run.outcome is Outcome.ALIGNED
    assert run.tau_align > 0.0


def test_without_asymmetry_in_force_and_tilt_the_edge_still_tilts_the_part(device):
    # φ(0) = 0, relaxed springs: A1 presses right of the centre, and so turns the part.
    run = simulate(device.replace(initial_tilt=0.0))
    assert run.outcome is Outcome.ALIGNED
    # Continuous in φ(0): at 1e-7 it is as good as zero (the time moves by about as much).
    near = simulate(device.replace(initial_tilt=1e-7))
    assert run.tau_align == pytest.approx(near.tau_align, abs=1e-4)


# ------------------------------------------------------------------------------ settled and horizon

PERIODIC = {"tilt_stiffness": 300.0, "friction": 0.3, "frequency": 1.0, "press_force": 2.0}


def test_a_motion_that_repeats_itself_settles(device):
    p = device.replace(**PERIODIC)
    run = simulate(p)
    assert run.outcome is Outcome.SETTLED
    assert run.period >= 1
    # It would not align however long one waits: ten times as long.
    on = simulate(p, may_settle=False, horizon=10 * run.time[-1])
    assert on.outcome is Outcome.HORIZON_REACHED
    # And it does repeat itself, with the period it names.
    period = run.period * 2 * pi / p.frequency

    def before_the_end(back):
        return [np.interp(on.time[-1] - back, on.time, column) for column in on.state.T]

    assert before_the_end(period) == pytest.approx(
        before_the_end(2 * period), abs=1e-4
    )  # linear interpolation of the track


def test_the_horizon_ends_a_run(device):
    run = simulate(device, horizon=1.0)
    assert ended(run) == (Outcome.HORIZON_REACHED, Reason.NONE)
    assert run.time[-1] == 1.0
    assert np.isnan(run.tau_align)
    assert "raise the horizon" in run.remedy


# ------------------------------------------------------------------------------ reasons of the end


@pytest.mark.parametrize(
    ("changes", "outcome", "reason", "message", "remedy"),
    [
        ({"rest_x": 5.0, "lateral_stiffness": 2.0},
         Outcome.LEFT_SCENE, Reason.MOVED_AWAY, "away from the slot", ""),
        ({"tilt_stiffness": 0.0, "inertia": 15.0, "frequency": 1.0},
         Outcome.LEFT_SCENE, Reason.OVERTURNED, "", ""),
        ({"initial_tilt": 1.6}, Outcome.FAILED, Reason.IMPOSSIBLE_START, "", ""),
        # s = (l - x)/cos φ - b tan φ < -a: A1 would be left of B2.
        ({"initial_tilt": 0.5}, Outcome.FAILED, Reason.IMPOSSIBLE_START, "", ""),
        ({"initial_tilt": 0.9}, Outcome.FAILED, Reason.IMPOSSIBLE_START, "", ""),
        ({"max_evaluations": 500}, Outcome.FAILED, Reason.TOO_MANY_EVALUATIONS,
         "limit of right-hand-side evaluations", "max_evaluations"),
    ],
)  # fmt: skip
def test_a_run_says_why_it_ends_and_what_to_do(device, changes, outcome, reason, message, remedy):
    settings = {name: changes[name] for name in changes if name == "max_evaluations"}
    p = device.replace(**{name: changes[name] for name in changes if name not in settings})
    run = simulate(p, **settings)
    assert ended(run) == (outcome, reason)
    assert message in run.message
    assert remedy in run.remedy
    assert np.isnan([run.tau_align, run.tau_error]).all()
    if reason is Reason.MOVED_AWAY:
        assert run.state[-1, 0] > device.misalignment
    elif reason is Reason.OVERTURNED:
        assert run.tilt_max == pytest.approx(pi / 2, abs=0.01)
        assert abs(run.state[-1, 2]) == run.tilt_max
    elif reason is Reason.IMPOSSIBLE_START:
        assert len(run.time) == 1


@pytest.mark.parametrize("changes", [{"press_force": 1e200}, {"press_force": -1e200}])
def test_an_absurd_force_fails_and_does_not_return_nan_states(device, changes):
    run = simulate(device.replace(**changes))
    assert run.outcome in (Outcome.FAILED, Outcome.LEFT_SCENE)
    assert run.reason is not Reason.NONE
    assert np.isfinite(run.state).all()


# ----------------------------------------------------------------------------------------- readings


def test_a_run_may_end_at_alignment(device):
    whole = align([device])
    part = align([device], alignment_only=True)
    assert part.outcome[0] == Outcome.ALIGNED
    assert part.tau_align[0] == whole.tau_align[0]
    assert np.isfinite([whole.tilt_max[0], whole.contact_force_max[0]]).all()
    assert np.isnan([part.tilt_max[0], part.contact_force_max[0]]).all()
    assert np.isfinite(whole.tau_corners_inside[0])
    assert np.isnan(part.tau_corners_inside[0])
    assert part.rhs_evaluations[0] < whole.rhs_evaluations[0]


def test_printed_criterion_keeps_the_horizon_after_the_contact_is_lost():
    # This part loses the contact past the corner at τ = 2.86 and rocks from then on, never with all
    # four corners inside: the run must last to its horizon, not for the time a fall may take.
    p = Parameters(
        half_width=1.3, half_height=1.7, inertia=19.0, lateral_stiffness=0.037, tilt_stiffness=24.0,
        lateral_damping=0.63, axial_damping=0.21, tilt_damping=1.2, friction=0.44, press_force=12.0,
        frequency=5.7, clearance=0.25, misalignment=0.95, initial_tilt=0.1, contact_stiffness=31.0,
        contact_damping=2.8,
    )  # fmt: skip
    assert simulate(p, horizon=60.0).tau_align == pytest.approx(2.86, abs=0.01)
    printed = simulate(p, readings=Variants(alignment_criterion="printed"), horizon=60.0)
    assert printed.outcome is Outcome.HORIZON_REACHED
    assert printed.time[-1] == 60.0


@pytest.mark.parametrize(
    ("press_force", "tilt_stiffness"),
    [(0.984924623116, 26.2110552764), (1.37688442211, 18.7788944724)],
)
def test_an_edge_that_clips_the_corner_for_an_instant_is_met(device, press_force, tilt_stiffness):
    # Two points of Fig. 13 where the falling part touches A1 within 1e-3 of its corner B1: the edge
    # is inside the part for less than a sampled part of a step. Missed, B1 ran into the wall.
    p = device.replace(
        friction=0.15, frequency=10.0, press_force=press_force, tilt_stiffness=tilt_stiffness
    )
    assert simulate(p).outcome is Outcome.ALIGNED
