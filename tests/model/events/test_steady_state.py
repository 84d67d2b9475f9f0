"""The criterion of periodic steady state, on sequences of states made by hand, one per period.

A creep under a fast transient must not pass for a periodic steady state.
"""

import numpy as np
import pytest

from model.compile.entries import compiled
from model.events import steady_state
from model.events.event_functions import NEVER
from model.events.kernels import MOST_EVENTS, events_of
from model.events.steady_state import HISTORY, LONGEST_PERIOD
from model.events.table import ALIGNED, FACE_LOAD
from vibralign import ALIGNMENT, Outcome, Parameters, simulate

record_closest, record_state, settled_period = map(
    compiled,
    (steady_state.record_closest, steady_state.record_state, steady_state.settled_period),
)
NOISE = 1e-8
FAR = 1.0


@pytest.fixture(scope="module")
def first_settled(device, constants):
    """(count, period) at which a sequence of states, shape (n, 6), is first called settled."""
    p, events = constants(device), events_of(ALIGNMENT.events)

    def make(states, closest=FAR, which=ALIGNED):
        history = np.full((HISTORY, 6), np.nan)
        lowest = np.full((LONGEST_PERIOD, MOST_EVENTS), NEVER)
        functions = np.full(MOST_EVENTS, NEVER)
        functions[which] = closest
        for count, state in enumerate(states, start=1):
            record_state(count, np.ones(6) * state, history)
            record_closest(count, functions, lowest)
            period = settled_period(events, count, 1.0, history, lowest, p, NOISE)
            if period:
                return count, period
        return None

    return make


def test_a_contracting_motion_settles_with_period_one(first_settled):
    count, period = first_settled(1.0 + 0.5 ** np.arange(60.0))
    assert period == 1
    assert count > 10  # differences have to be small first


@pytest.mark.parametrize("length", [2, 3, 5, LONGEST_PERIOD])
def test_a_motion_of_several_periods_is_told_its_own(first_settled, length):
    cycle = np.tile(np.arange(length, dtype=float), 40)
    assert first_settled(cycle + 0.5 ** np.arange(cycle.size))[1] == length


@pytest.mark.parametrize(
    "states",
    [
        np.random.default_rng(0).normal(size=(200, 6)),
        1e-6 * np.arange(200.0),  # differences are small, but what is left to move is unbounded
        1e-6 * 1.05 ** np.arange(100.0),
    ],
    ids=["wanders", "drifts", "grows"],
)
def test_a_motion_that_does_not_contract_does_not_settle(first_settled, states):
    assert first_settled(states) is None


def test_a_slow_approach_settles_only_once_the_rest_of_the_motion_is_small(first_settled):
    # With differences of 0.9^n the rest of the motion is 9 · 0.9^n. It must be smaller than the
    # distance of 1e-3 to an event by the safety factor.
    states = 1.0 + 0.9 ** np.arange(300.0)
    closest = 1e-3
    count, period = first_settled(states, closest=closest)
    assert period == 1
    left = abs(states[count - 1] - 1.0)
    assert left < closest / 10


def test_an_event_that_is_nearly_reached_forbids_settling(first_settled):
    states = 1.0 + 0.5 ** np.arange(100.0)
    assert first_settled(states, closest=FAR) is not None
    # Noise of 1e-8 may move a length by 1e-8 times lever arms of 6, a load by a hundred times that.
    assert first_settled(states, closest=1e-9) is None
    assert first_settled(states, closest=1e-6, which=ALIGNED) is not None
    assert first_settled(states, closest=1e-6, which=FACE_LOAD) is None


# ------------------------------------------------------------------------ a creep under a transient

# Stick-slip that moves the part 2e-5 toward the slot in each period, a little more each time.
CREEPING = Parameters(
    half_width=1.0805176105745062, half_height=3.989955500115412, inertia=19.2854006941775,
    lateral_stiffness=0.038974148223245644, tilt_stiffness=19.477306606834492,
    lateral_damping=1.6321848583761482, axial_damping=0.2744001347107305,
    tilt_damping=3.7003678872049766, friction=0.2923799027261509,
    press_force=1.9845837404845554, frequency=2.223124645049393,
    clearance=0.041497328087292555, misalignment=0.37426994714935263,
    initial_tilt=0.007346662744698667, contact_stiffness=106.95126947856185,
    contact_damping=0.7958812622141187, phase=0.9014785550564973,
    rest_tilt=0.0023258541802665695,
)  # fmt: skip

# Every period moves the part by 8e-6. As the differences came near to that, their ratio was 0.97.
CREEPING_UNDER_ITS_TRANSIENT = Parameters(
    half_width=0.834191413668121, half_height=4.738306115865365, clearance=0.04958405253325964,
    misalignment=0.29266265898377913, initial_tilt=0.0002425760594668097,
    inertia=15.10489676176695, lateral_stiffness=0.16491636169049084,
    tilt_stiffness=23.72647971373727, lateral_damping=0.8851393872416321,
    axial_damping=0.9683419689967324, tilt_damping=0.4316223417875746,
    contact_stiffness=91.67351207214264, contact_damping=1.428041981038863,
    friction=0.4109302369572618, press_force=3.1612513970889182, frequency=7.2084758108207,
    rest_tilt=0.002178054431544975,
)  # fmt: skip


def periods(count):
    return np.arange(float(count))[:, None]


def dying_out(ratio):
    return 1e-3 * ratio ** periods(100) * np.array([0.0, 0.0, 0.0, 1.0, 0.5, 0.2])


@pytest.mark.parametrize("ratio", [0.2, 0.5])
@pytest.mark.parametrize("creep", [1e-6, 1e-7])
def test_a_creep_under_a_transient_does_not_settle(first_settled, ratio, creep):
    # x and tilt creep, velocities die out at first much faster than that: in 3,000 time units
    # the creep would cover more than the distance to alignment, 1e-4.
    transient = dying_out(ratio)
    drift = creep * periods(100) * np.array([1.0, 0.1, 0.1, 0.0, 0.0, 0.0])
    assert first_settled(transient + drift, 1e-4) is None


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.7, 0.8, 0.9])
@pytest.mark.parametrize("creep", [1e-5, 1e-6, 1e-7, -1e-5, -1e-6, -1e-7])
def test_a_creep_along_its_transient_does_not_settle(first_settled, ratio, creep):
    # The ratio of the differences rises from that of the transient to 1.
    moved = creep * periods(300) + 1e-3 * ratio ** periods(300)
    assert first_settled(moved * np.array([1.0, 0.1, 0.1, 0.5, 0.1, 0.1]), 1e-4) is None


def test_one_contraction_is_no_evidence(first_settled):
    # The first three periods have two differences, so one ratio; two are wanted.
    sequence = np.array([0.0, 1e-3, 1.1e-3])[:, None] * np.ones(6)
    assert first_settled(sequence, 1.0) is None


def test_a_run_that_creeps_to_the_slot_does_not_settle():
    run = simulate(CREEPING, horizon=1600.0)
    assert run.outcome is Outcome.ALIGNED
    assert run.tau_align == pytest.approx(1497.0, abs=1.0)


def test_a_run_that_creeps_under_its_transient_does_not_settle():
    run = simulate(CREEPING_UNDER_ITS_TRANSIENT, horizon=120.0)
    assert run.outcome is Outcome.HORIZON_REACHED


@pytest.mark.parametrize("turns", [2, 3, 5, 7])
def test_a_transient_that_turns_as_it_decays_has_the_period_of_its_cycle(first_settled, turns):
    # After ``turns`` periods it points the same way again, and no sooner.
    angle = 2.0 * np.pi / turns * periods(400)
    turning = 0.95 ** periods(400) * np.hstack([np.cos(angle), np.sin(angle)] * 3)
    _, period = first_settled(1.0 + 1e-2 * turning)
    assert period == 1
    cycle = np.arange(400)[:, None] % 2
    assert first_settled(cycle + 1e-2 * turning)[1] == 2
