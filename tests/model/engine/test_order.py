"""Fixed steps: the order of DOP853 on smooth stretches and across every kind of event.

The driver takes equal steps with the engine's functions. At an event it does as the engine's loop:
it repeats the step up to the event and continues from there in the next mode.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pytest

from model.engine.scalar.location import NO_EVENT
from model.engine.scalar.step import error_estimate
from model.engine.scalar.tableaux import DOP853
from model.events.friction import decide_friction
from model.events.table import EVENTS
from model.events.transitions import CONTINUES
from model.physics.geometry import resting_height
from model.physics.modes import START, Mode
from model.physics.notation import State
from tests.model.engine.steps import Steps, interpolate

NAMES = [event.name.upper() for event in EVENTS]


class Met(NamedTuple):
    """An event: when, which one, the modes before and after it."""

    time: float
    which: str
    before: Mode
    after: Mode


class FixedSteps(Steps):
    """Runs with equal steps that are repeated up to each event."""

    def to_event(self, which, theta, time, h, y, mode):
        """(length, state): Newton's iteration on whole steps, slope from the dense output."""
        low, high = max(theta - 1e-3, 0.0), min(theta + 1e-3, 1.0)
        ends = [np.array(interpolate(at, h, y, self.dense)) for at in (low, high)]
        values = [
            self.level(which, time + at * h, end, mode)
            for at, end in zip((low, high), ends, strict=True)
        ]
        slope, length = (values[1] - values[0]) / ((high - low) * h), theta * h
        for _ in range(4):
            end = self.step(time, length, y, mode)
            value = self.level(which, time + length, end, mode)
            length = min(max(length - value / slope, 0.0), h)
        return length, self.step(time, length, y, mode)

    def run(self, time, y, mode, until, count):
        """(state at ``until``, mode, events) after ``count`` equal steps."""
        met, begin, h = [], time, (until - time) / count
        for i in range(count):
            stop = begin + (i + 1) * h
            while time < stop:
                length = stop - time
                whole = self.dense_step(time, length, y, mode)
                which, theta = self.first_event(time, length, y, mode)
                if theta == NO_EVENT:
                    time, y = stop, whole
                else:
                    if theta > 0.0:
                        length, y = self.to_event(which, theta, time, length, y, mode)
                        time += length
                    y, after, outcome = self.pass_event(which, time, y, mode)
                    assert len(met) < 1000, met[-3:]
                    met.append(Met(time, NAMES[which], mode, after))
                    mode = after
                    if outcome != CONTINUES and NAMES[which] not in ("ALIGNED", "FACE_END"):
                        return y, mode, met
                y = self.held(y, mode)
        return y, mode, met

    def start(self):
        """State and mode at rest, touching the edge."""
        y = np.zeros(6)
        y[0], y[1], y[2] = self.p.misalignment, resting_height(self.p), self.p.initial_tilt
        return y, decide_friction(0.0, State(*y), self.p, START, True, True)[0]


HOPS = {"frequency": 10.0}
SLOW = {"frequency": 0.5}
LANDS = {"press_force": 0.5, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.05}

# What differs from the device, from when to when (the second plus up to 4 % of the length), and the
# events in between, each with the support's friction state before and after it.
STRETCHES = {
    "sticking": (SLOW, 2.0, 3.0, ()),
    "lift-off": (HOPS, 0.36, 0.74, (("FACE_LOAD", 1, 1), ("FACE_GAP", 1, 1))),
    "touch-down": (HOPS, 0.64, 1.13, (("RIGHT_EDGE_ENTERS", 1, 1),)),
    "slip reversal": (LANDS, 1.3, 2.1, (("SUPPORT_SLIP", 1, -1),)),
    "slip to stick": (SLOW, 1.3, 2.0, (("SUPPORT_SLIP", 1, 0),)),
    "stick to slip": (SLOW, 3.9, 4.6, (("SUPPORT_SLIP", 0, -1),)),
    "side contact begins": (SLOW, 4.5, 5.08, (("LEFT_EDGE_ENTERS", -1, -1),)),
    "released contact loads again": (
        SLOW, 5.24, 5.44, (("SIDE_LOAD", 1, 1), ("SIDE_RELOAD", 1, 1)),
    ),
    "face ends": (SLOW, 8.0, 8.94, (("FACE_END", -1, -1),)),
    "aligned in flight": (LANDS, 6.2, 8.46, (("ALIGNED", 1, 1), ("CORNERS_INSIDE", 1, 1))),
    "corner lands": (
        LANDS, 4.4, 4.74, (("RIGHT_CORNER_LANDS", 1, 1), ("RIGHT_EDGE_ENTERS", 1, 1)),
    ),
    "corner and edge lift off": (
        LANDS, 4.66, 4.96,
        (("CORNER_LOAD", 1, 1), ("FACE_LOAD", 1, 1), ("CORNER_GAP", 1, 1), ("FACE_GAP", 1, 1)),
    ),
}  # fmt: skip
each_stretch = pytest.mark.parametrize("stretch", STRETCHES)


def kinds(met):
    return tuple((one.which, one.before.support_slip, one.after.support_slip) for one in met)


@pytest.fixture(scope="module")
def begun(device, constants):
    """(constants, τ, state, mode) where a stretch begins, from a run at rest."""

    @lru_cache
    def make(stretch):
        changes, begin, *_ = STRETCHES[stretch]
        p = constants(device.replace(**changes))
        steps = FixedSteps(p)
        y, mode, _ = steps.run(0.0, *steps.start(), begin, math.ceil(begin / 0.01))
        return p, begin, y, mode

    return make


def mean_errors(stretch, begun, counts, repeats):
    """Errors of the state and of event times at the end, for every number of steps in ``counts``.

    The geometric mean over ends that differ a little. Where an event lies in its step changes the
    error by a factor, but not its order.
    """
    p, begin, y, mode = begun
    _, _, until, expected = STRETCHES[stretch]
    steps, logs = FixedSteps(p), []
    for end in until + (until - begin) * np.linspace(0.0, 0.03, repeats):
        best, _, met = steps.run(begin, y, mode, end, 64)
        assert kinds(met) == expected
        row = []
        for count in counts:
            state, _, found = steps.run(begin, y, mode, end, count)
            assert kinds(found) == expected
            times = [abs(one.time - other.time) for one, other in zip(found, met, strict=True)]
            row.append(max(np.abs(state - best).max(), *times, 1e-16))
        logs.append(np.log(row))
    return np.exp(np.mean(logs, axis=0))


def slope(counts, errors):
    """Exponent of errors ~ counts^-slope, by least squares in logarithms."""
    return -np.polyfit(np.log(counts), np.log(errors), 1)[0]


@each_stretch
def test_order_down_to_rounding(begun, stretch):
    # Errors are proportional to h^8 below about 1e-10. Rounding adds about 3e-13 where an event is
    # located at a small slope. Between the two lie two decades, in which h changes by a factor of
    # two; five halvings would need twelve. Many sizes and ends make up for it.
    counts = np.array([6, 7, 8, 9, 10, 11, 12, 13, 14, 16, 18, 20, 22, 24, 26, 28, 32, 36])
    errors = mean_errors(stretch, begun(stretch), counts, repeats=10)
    asymptotic = (errors < 1e-10) & (errors > 5e-13)
    assert asymptotic.sum() >= 5
    assert slope(counts[asymptotic], errors[asymptotic]) > 0.95 * DOP853.order


@each_stretch
def test_order_of_the_error_estimate(begun, stretch):
    p, begin, y, mode = begun(stretch)
    # Between pre-asymptotic steps and rounding.
    steps, sizes = FixedSteps(p), 0.045 / 2 ** np.linspace(0.0, 2.0, 6)
    logs, ahead = [], 0.02 * (STRETCHES[stretch][2] - begin)
    for i in range(8):  # a coefficient of the error may vanish at one state, not at all of them
        time = begin + i * ahead
        row = []
        for h in sizes:
            steps.step(time, h, y, mode)
            row.append(error_estimate(h, y, steps.end, steps.k, 1.0))
        logs.append(np.log(row))
        y, _, met = FixedSteps(p).run(time, y, mode, time + ahead, 2)
        assert not met
    # A local error of a method of order p is O(h^(p+1)).
    observed = slope(1.0 / sizes, np.exp(np.mean(logs, axis=0)))
    assert observed > 0.95 * (DOP853.error_order + 1)
