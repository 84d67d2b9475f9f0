"""The criterion of periodic steady state, on sequences of states made by hand, one per period."""

import numpy as np
import pytest

from model.events.event_functions import NEVER
from model.events.kernels import ALIGNMENT_EVENTS, MOST_EVENTS
from model.events.steady_state import (
    HISTORY,
    LONGEST_PERIOD,
    record_closest,
    record_state,
    settled_period,
)
from model.events.table import ALIGNED, FACE_LOAD

NOISE = 1e-8
FAR = 1.0


@pytest.fixture(scope="module")
def first_settled(device, constants):
    """(count, period) at which a sequence of states is first called settled, or None."""
    p = constants(device)

    def make(states, closest=FAR, which=ALIGNED):
        history = np.full((HISTORY, 6), np.nan)
        lowest = np.full((LONGEST_PERIOD, MOST_EVENTS), NEVER)
        functions = np.full(MOST_EVENTS, NEVER)
        functions[which] = closest
        for count, state in enumerate(states, start=1):
            record_state(count, np.ones(6) * state, history)
            record_closest(count, functions, lowest)
            period = settled_period(ALIGNMENT_EVENTS, count, 1.0, history, lowest, p, NOISE)
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


def test_a_motion_that_wanders_does_not_settle(first_settled):
    assert first_settled(np.random.default_rng(0).normal(size=(200, 6))) is None


def test_a_drift_does_not_settle_however_slow(first_settled):
    # The differences are small but do not contract: what is left to move is unbounded.
    assert first_settled(1e-6 * np.arange(200.0)) is None


def test_a_growing_motion_does_not_settle(first_settled):
    assert first_settled(1e-6 * 1.05 ** np.arange(100.0)) is None


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
