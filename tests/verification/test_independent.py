"""The independent solution agrees with the integrator through every kind of event."""

import math
from dataclasses import replace

import numpy as np
import pytest

from verification.accuracy import LEAVING
from verification.fuzz import IN_SLOT, LAWS_IN_SLOT, draw
from verification.independent import insert, solve, solve_round
from verification.independent.crossings import first_event
from verification.independent.motion import Device, Mode
from verification.independent.solution import MOMENT, Run
from vibralign import Outcome, Parameters, Reason, simulate

# Without an end by settling: in the independent solution a part rests if both sides stick.
SETTINGS = replace(IN_SLOT, horizon=12.0, may_settle=False, max_evaluations=1_000_000)

# Parameters that differ from the device, and events that the run must meet.
RUNS = {
    "slides one way": ({"friction": 0.0, "frequency": 1.0}, {"face end"}),
    "reversals and sticking": ({"frequency": 0.5, "press_force": 2.0}, {"slip"}),
    "lift-offs": ({"frequency": 10.0}, {"slip", "face load", "face gap", "right enters"}),
    "corner landings, alignment in flight": (
        {"press_force": 0.5, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.05},
        {"right lands", "corner load", "corner gap", "aligned"},
    ),
    "side contact, released and loaded again": (
        {"frequency": 0.5},
        {"left enters", "side slip", "side load", "side reload"},
    ),
    # 1 + (s² - μ s b)/I = -5 at s = 0.54: on a rigid base, a contact that slides this way has none.
    "Painlevé's paradox": (
        {"inertia": 0.3, "half_height": 4.0, "friction": 1.0, "misalignment": 0.6},
        {"face load"},
    ),
}

# It drops, is lifted out again, and drops for good at 10.713.
DROPS_TWICE = Parameters(
    half_width=1.192508955382865,
    half_height=3.3150248680345955,
    inertia=5.347262382345785,
    lateral_stiffness=0.07872073655779752,
    tilt_stiffness=28.923892857979038,
    lateral_damping=1.4479475686623315,
    axial_damping=0.17695442304328834,
    tilt_damping=3.60704045302247,
    friction=0.011175733037385829,
    press_force=0.5178183576535969,
    frequency=0.766911126765268,
    clearance=0.08117573774499356,
    misalignment=0.19652669035229786,
    initial_tilt=0.00010928407926756685,
    contact_stiffness=148.05127451604588,
    contact_damping=1.5520523278342149,
    rest_tilt=0.008511648378295064,
)


@pytest.mark.parametrize(("changes", "kinds"), RUNS.values(), ids=list(RUNS))
def test_it_agrees_with_the_integrator(device, changes, kinds):
    p = device.replace(**changes)
    run = simulate(p, tolerance=1e-13)
    solution = solve(p, run.tau_align + 1.0)
    assert solution.ending == "aligned"
    assert kinds <= set(solution.events)
    # Both have errors of the order of their tolerance, 1e-13, times an amplification that
    # tau_error shows too.
    assert solution.tau == pytest.approx(run.tau_align, abs=1e-12 + run.tau_error)


def test_a_part_that_does_not_align_reaches_the_horizon(device):
    solution = solve(device, 0.5)
    assert (solution.ending, solution.time) == ("horizon", 0.5)
    assert math.isnan(solution.tau)


def test_it_says_how_the_scene_is_left(device):
    p = device.replace(tilt_stiffness=0.0, press_force=5.0)
    run = simulate(p)
    solution = solve(p, 300.0, tolerance=1e-10)
    assert run.outcome is Outcome.LEFT_SCENE
    assert solution.ending == "overturned"
    assert solution.time == pytest.approx(run.time[-1], abs=1e-6)


def test_the_first_drop_is_the_alignment():
    # R8: the first instant with A1 past B1 and B2 in the slot, in contact or in flight.
    solution = solve(DROPS_TWICE, 20.0)
    assert solution.tau == pytest.approx(4.934581453, abs=1e-8)
    run = simulate(DROPS_TWICE)
    assert run.tau_align == pytest.approx(solution.tau, abs=10 * run.tau_error)
    assert run.tau_corners_inside >= run.tau_align


@pytest.mark.parametrize(
    ("number", "solver", "shape"), [(31686, solve, "square"), (34147, solve_round, "round")]
)
def test_a_level_that_begins_at_zero_may_fall_and_rise_within_a_step(number, solver, shape):
    # Sets of the fuzz: a part is lifted off at once and lands again; a gap opens right after its
    # load is lost, and closes again.
    p = draw(7, number, 1)[0]
    run = simulate(p, horizon=5.0, tolerance=1e-9, shape=shape)
    assert solver(p, 5.0, 1e-12).tau == pytest.approx(run.tau_align, abs=10.0 * run.tau_error)


def test_a_corner_that_passes_the_edge_deep_in_the_flat_leaves_the_scene():
    p = draw(7, 1145, 1)[0]
    run = simulate(p, horizon=5.0, tolerance=1e-9, shape="round")
    solution = solve_round(p, 5.0, 1e-12)
    assert (run.reason, solution.ending) == (Reason.EDGE_ON_OTHER_FACE, "other face")
    assert solution.time == pytest.approx(run.time[-1], abs=1e-9)


# Sets of the fuzz, their endings in the independent solution, and contacts that they must meet.
IN_SLOT_RUNS = {
    "all four contacts": (33, "inserted", {"right_side load", "right_wall load", "left_wall load"}),
    "a corner behind the wall as it falls in": (49, "inserted", {"right_wall load"}),
    "a corner behind the wall for a moment": (3654, "inserted", set()),
    "a corner that stands on the flat as it falls in": (1368, "inserted", {"corner end"}),
    "held at two points": (3451, "wedged", {"right_wall touches"}),
    "an edge meets the top": (853, "other face", set()),
    "out again on an edge": (3216, "climbed out", set()),
}


def ends_as(run, ending: str) -> bool:
    """Return whether an ending of the independent solution agrees with outcome and reason."""
    if run.outcome is Outcome.INSERTED:
        return ending == "inserted"
    if run.outcome is Outcome.JAMMED:
        return ending == {Reason.WEDGED: "wedged"}.get(run.reason, "lack of force")
    return ending in {Reason.ON_EDGE: ("climbed out",), **LEAVING}.get(run.reason, ())


@pytest.mark.parametrize(
    ("number", "ending", "kinds"), IN_SLOT_RUNS.values(), ids=list(IN_SLOT_RUNS)
)
def test_it_agrees_in_the_slot(number, ending, kinds):
    batch = draw(2007, number, 1, LAWS_IN_SLOT)
    settings = replace(SETTINGS, tolerance=1e-11)
    run = simulate(batch[0], settings)
    (depth,) = batch.insertion_depths().tolist()
    solution = insert(batch[0], settings.horizon, depth, 1e-13)
    assert solution.ending == ending
    assert ends_as(run, solution.ending)
    assert kinds <= set(solution.events)
    assert solution.tau == pytest.approx(run.tau_align, abs=1e-11 + run.tau_error)
    if ending == "inserted":
        inserted = run.tau_align + run.tau_inserted
        assert solution.time == pytest.approx(inserted, abs=1e-11 + run.insertion_error)


def test_a_dip_between_the_last_two_samples_of_a_step_is_found():
    def gap(time, _state):  # falls below zero at 0.9895, for 0.002
        return np.abs(np.asarray(time) - 0.9905) - 0.001

    name, time = first_event({"enters": gap}, lambda time: time, 0.0, 1.0, "")
    assert name == "enters"
    assert time == pytest.approx(0.9895, abs=1e-12)


def test_an_unloaded_contact_slides_as_it_is_driven_though_friction_soon_stops_it(device):
    # Flat and at rest, only the tilt's spring drives it, and the load grows as n = h f0 τ. Friction
    # T = -drive / (1 + b²/I) would hold it, which μ n is after half a moment.
    inertia, b = device.inertia, device.half_height
    force = 0.5 * device.friction * device.contact_damping * device.press_force * MOMENT
    moment = -force * (inertia + b**2) / b
    p = device.replace(initial_tilt=0.0, rest_tilt=moment / device.tilt_stiffness)
    z = np.array([p.misalignment, b, 0.0, 0.0, 0.0, 0.0])
    assert Run(Device(p), 1e-12).decided(0.0, z, Mode(), True, False).slides == -1
    assert solve(p, 0.1).events[0] == "slip"
