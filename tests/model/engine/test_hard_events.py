"""Hard events: grazing, two in a step, simultaneous ones, motion along the boundary of a mode."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from model.engine.event_search import NO_EVENT
from model.events.kernels import level
from model.events.table import FACE_GAP, FACE_LOAD, RIGHT_CORNER_LANDS, RIGHT_EDGE_ENTERS
from model.events.transitions import CONTINUES
from model.physics.geometry import bottom_corner, edge_place
from model.physics.modes import CLOSED, OPEN, START
from model.physics.notation import RIGHT_EDGE, State
from tests.model.engine.steps import ALIGNMENT_EVENTS, OneRun
from vibralign import Outcome, Parameters, Reason, Settings, align, simulate

FLIGHT = START._replace(face=OPEN)
H = 0.2  # a step in flight: a fortieth of the slowest period


class Flight(OneRun):
    """Steps from a state in flight at τ = 0; no force depends on time."""

    def state(self, y, length, mode=FLIGHT):
        """The state ``length`` later, without any event."""
        while length > 0.0:
            self.put(y, mode)
            made = self.step(length)
            y, length = self.at(min(1.0, length / made)), length - made
        return y

    def first(self, y, mode=FLIGHT, length=H):
        """(which, when) of the first event within a length."""
        passed = 0.0
        while passed < length:
            self.put(y, mode)
            made = self.step(length - passed)
            which, theta = self.first_event()
            if theta != NO_EVENT:
                return which, passed + theta * made
            y, passed = self.at(1.0), passed + made
        return -1, NO_EVENT


@pytest.fixture(scope="module")
def rebound(device, constants):
    """(flight, state(height, where)): comes down to ``height`` of the face over A1 and up again.

    Pulled up by 3, it falls at a speed that is used up after the share ``where`` of the step.
    """
    p = constants(device.replace(press_force=-3.0, frequency=0.0))
    flight = Flight(p)

    def gap(y):
        return -(p.half_height + edge_place(RIGHT_EDGE, y[0], y[1], y[2], p).along_axis)

    def lowest(y):
        return minimize_scalar(
            lambda t: gap(flight.state(y, t)), bounds=(0.0, H), method="bounded",
            options={"xatol": 1e-12},
        )  # fmt: skip

    def make(height, where):
        def state(y_place):
            return np.array([0.3, y_place, 0.02, 0.1, -3.0 * where * H, 0.05])

        # The lowest gap grows with y, near enough one to one.
        y_place = brentq(lambda v: lowest(state(v)).fun - height, 4.0, 4.4, xtol=1e-15)
        return state(y_place), lowest(state(y_place)).x

    return flight, make


@pytest.mark.parametrize("where", [0.2, 0.33, 0.5, 0.9])
@pytest.mark.parametrize("height", [1e-3, 1e-6, 1e-9])
def test_a_part_is_met_where_it_just_touches_within_the_step(rebound, height, where):
    flight, make = rebound
    y, _ = make(height, where)
    assert flight.first(y) == (-1, NO_EVENT)
    # Two crossings in one step, 2 √(2 d / a) apart: 9e-5 for the shallowest, at a = 3 upward.
    y, bottom = make(-height, where)
    which, met = flight.first(y)
    assert which == RIGHT_EDGE_ENTERS
    half = np.sqrt(2.0 * height / 3.0)
    assert bottom - met == pytest.approx(half, rel=0.05)  # springs change a = 3 by some per cent


def test_the_state_after_a_graze_is_that_without_it(rebound):
    # A contact of depth d lasts for √d with a force of order √d: its impulse is of order d.
    flight, make = rebound
    for depth in (1e-6, 1e-9):
        y, _ = make(-depth, 0.5)
        free = flight.state(y, H)
        after, mode, met = through(flight, y, FLIGHT, H)
        assert met[0] == RIGHT_EDGE_ENTERS
        assert {FACE_LOAD, FACE_GAP} <= set(met)
        assert mode.face == OPEN
        assert np.abs(after - free).max() < 100 * depth


def through(flight, y, mode, until):
    """(state, mode, events) after ``until``; the step is repeated up to each event."""
    time, met = 0.0, []
    while time < until:
        which, when = flight.first(y, mode, until - time)
        if when == NO_EVENT:
            y, time = flight.state(y, until - time, mode), until
        else:
            y, time = (flight.state(y, when, mode) if when > 0.0 else y), time + when
            y, mode, outcome = flight.pass_event(which, time, y, mode)
            assert outcome == CONTINUES
            met.append(which)
            assert len(met) < 50  # no chatter
        y = flight.held(y, mode)
    return y, mode, met


# ------------------------------------------------------------------------------------ simultaneous


def landing(p, tilt):
    """B1 and A1 both 0.01 above their contacts when the tilt, falling, passes ``tilt``."""
    x, speed, turn = 0.4, -0.5, -0.3
    fall = 0.01 / -speed
    y = np.array([x, 0.0, tilt - turn * fall, 0.0, speed, turn])
    corner_y = bottom_corner(RIGHT_EDGE, x, 0.0, tilt, p)[1]
    y[1] = -corner_y - speed * fall
    return y


def test_edge_and_corner_that_meet_the_part_at_once_both_carry_it(device, constants):
    # It lands flat: A1 enters through the bottom in the instant in which B1 comes to the flat and
    # becomes the lower corner. Whichever comes first by rounding, the motion is the same.
    flight = Flight(constants(device.replace(frequency=0.0)))
    runs = {
        tilt: through(flight, landing(flight.p, tilt), FLIGHT, 0.04)
        for tilt in (0.0, 1e-9, -1e-9, 1e-7, -1e-7)
    }
    flat, mode, met = runs[0.0]
    assert {RIGHT_EDGE_ENTERS, RIGHT_CORNER_LANDS} <= set(met)
    assert (mode.face, mode.corner) == (CLOSED, CLOSED)
    for tilt, (state, its_mode, _) in runs.items():
        assert its_mode == mode._replace(corner_offset=its_mode.corner_offset)
        # Loads change by stiffness times arm times tilt, 500 |tilt|, for 0.02.
        assert np.abs(state - flat).max() <= 100 * abs(tilt) + 1e-12


def test_the_earliest_of_nearly_simultaneous_events_comes_first(device, constants):
    flight = Flight(constants(device.replace(frequency=0.0)))
    for tilt in (1e-4, -1e-4):
        y = landing(flight.p, tilt)
        which, when = flight.first(y)
        q = State(*flight.state(y, when).tolist())
        levels = {
            each: level(ALIGNMENT_EVENTS, each, when, q, flight.p, FLIGHT)
            for each in (RIGHT_EDGE_ENTERS, RIGHT_CORNER_LANDS)
        }
        assert abs(levels.pop(which)) < 1e-11  # the error of a step
        assert min(levels.values()) > 0.0


# ------------------------------------------------------------------------- at a mode's boundary

# Each keeps the part on the boundary of two modes, or brings it back there again and again.
BOUNDARIES = {
    # f0 = 0, springs relaxed, no tilt: the load is zero for ever.
    "no load": {"press_force": 0.0, "frequency": 0.0, "initial_tilt": 0.0},
    # f0 = 1 and an excitation from -1 to 1: the load touches zero once a period.
    "load that grazes zero": {"press_force": 1.0, "frequency": 0.3, "phase": 0.0},
    # The friction force needed equals its limit: tan φ = μ on a locked part.
    "at the friction angle": {
        "inertia": 1e12, "initial_tilt": 0.1, "rest_tilt": 0.1, "friction": np.tan(0.1),
        "frequency": 0.0, "lateral_stiffness": 0.0, "tilt_damping": 0.0,
    },
    # Friction that changes its direction within every period of a fast excitation.
    "reversals without end": {"frequency": 200.0, "press_force": 1.0, "friction": 0.3},
    # A soft base without damping and no way to the slot: lift-offs that never end.
    "lift-offs that do not end": {
        "contact_damping": 0.0, "axial_damping": 0.0, "press_force": 0.5, "frequency": 3.0,
        "tilt_stiffness": 1e4, "friction": 1e-9,
    },
    # Hops on a hard base that shorten to nothing.
    "lift-offs that shorten": {
        "contact_stiffness": 1e6, "contact_damping": 300.0, "press_force": 0.3, "frequency": 0.0,
        "phase": -1.5, "tilt_stiffness": 1e4,
    },
    # The part stands flat, on edge and corner at once.
    "flat on edge and corner": {
        "initial_tilt": 0.0, "tilt_stiffness": 1e6, "misalignment": 1.0, "frequency": 10.0,
    },
}  # fmt: skip


@pytest.mark.parametrize("changes", BOUNDARIES.values(), ids=list(BOUNDARIES))
@pytest.mark.parametrize("tolerance", [1e-10, 1e-7, 1e-5])
def test_a_run_along_a_boundary_ends_with_a_defined_outcome(device, changes, tolerance):
    run = simulate(
        device.replace(**changes), tolerance=tolerance, horizon=30.0, may_settle=False,
        max_evaluations=3_000_000,
    )  # fmt: skip
    # The run ends without the evaluation limit or steps of no length. If its errors are as large as
    # the difference between the two modes, it may report chatter.
    if run.outcome is Outcome.FAILED:
        assert run.reason is Reason.CHATTER
        assert tolerance > 1e-8
    assert np.isfinite(run.state).all()
    assert np.isnan(run.tau_align) == (run.outcome is not Outcome.ALIGNED)


def test_two_crossings_right_after_an_event_are_found():
    """A1 is past B1 for 4e-9 before B2 leaves the slot again; set 24584 of the random sets."""
    part = Parameters(
        half_width=0.01720107408067621, half_height=0.14127879747675992,
        clearance=1.0013570728290877e-08, misalignment=0.0021420394747234442,
        initial_tilt=0.0, inertia=0.00023284397057132025,
        lateral_stiffness=3997.711688356001, tilt_stiffness=0.0010005000770710198,
        lateral_damping=0.7407903283831649, axial_damping=2.6106464608664917, tilt_damping=0.0,
        contact_stiffness=11162889.66847919, contact_damping=0.04228888094476304,
        friction=2.2070862887072575, press_force=0.0, frequency=304.8539728316224,
        phase=-0.19376278644259384, rest_x=-0.028459289008773665, rest_tilt=2.2745447522134357e-05,
    )  # fmt: skip
    found = align([part], Settings(horizon=0.05, tolerance=1e-10), cores=1)
    assert found.tau_align[0] == pytest.approx(0.00603080146, abs=1e-9)
