"""Steps of DOP853 in the alignment scene, for tests that take them one at a time.

A call takes the time of its arguments: constants are passed as an array, and a kernel does all that
one call may do.
"""

import numpy as np

from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.engine.record import constants_in
from model.engine.scalar import location, step
from model.engine.scalar.location import NODES
from model.engine.scalar.tableaux import DOP853
from model.events import friction, kernels
from model.events.kernels import MOST_SAMPLES, events_of
from model.physics.notation import State
from vibralign import ALIGNMENT

ALIGNMENT_EVENTS = events_of(ALIGNMENT.events)
interpolate = compiled(step.interpolate)


@compiled
@kernel
def take_step(events, time, h, y, row, mode, k, end):
    p = constants_in(events, row)
    step.right_hand_side(time, y, p, mode, k[0])
    step.take_step(time, h, y, p, mode, k, end)


@compiled
@kernel
def take_dense_step(events, time, h, y, row, mode, k, end, trial, dense):
    p = constants_in(events, row)
    step.right_hand_side(time, y, p, mode, k[0])
    step.take_step(time, h, y, p, mode, k, end)
    step.dense_output(time, h, y, p, mode, k, trial, dense)


@compiled
@kernel
def locate(events, time, h, y, dense, row, mode, nodes, samples):
    p = constants_in(events, row)
    location.sample_step(events, time, h, 1.0, y, dense, p, mode, nodes, samples)
    return location.first_event(events, time, h, y, dense, p, mode, samples)


@compiled
@kernel
def level_at(events, which, time, y, row, mode):
    return kernels.level(events, which, time, step.state_of(y), constants_in(events, row), mode)


@compiled
@kernel
def hold(events, y, row, mode):
    step.store_in(friction.hold_sticking(step.state_of(y), constants_in(events, row), mode), y)


class Steps:
    """The engine's functions of one step, with the arrays that they fill."""

    def __init__(self, p):
        self.p, self.row = p, np.array(p)
        stages, degree = DOP853.dense.shape
        self.k, self.end, self.trial = np.empty((stages, 6)), np.empty(6), np.empty(6)
        self.dense = np.empty((6, degree))
        self.nodes, self.samples = np.empty((NODES, 6)), np.empty((NODES, MOST_SAMPLES))

    def step(self, time, h, y, mode):
        """The state after a step of length ``h``."""
        take_step(ALIGNMENT_EVENTS, time, h, y, self.row, mode, self.k, self.end)
        return self.end.copy()

    def dense_step(self, time, h, y, mode):
        """As ``step``; fills the dense output."""
        arrays = self.k, self.end, self.trial, self.dense
        take_dense_step(ALIGNMENT_EVENTS, time, h, y, self.row, mode, *arrays)
        return self.end.copy()

    def first_event(self, time, h, y, mode):
        """(which, θ) of the first event on the dense output."""
        return locate(
            ALIGNMENT_EVENTS, time, h, y, self.dense, self.row, mode, self.nodes, self.samples
        )

    def level(self, which, time, y, mode):
        """The level of an event at the state ``y``."""
        return level_at(ALIGNMENT_EVENTS, which, time, y, self.row, mode)

    def held(self, y, mode):
        """The state ``y`` with sticking contacts at rest."""
        y = y.copy()
        hold(ALIGNMENT_EVENTS, y, self.row, mode)
        return y

    def pass_event(self, which, time, y, mode):
        """(state, mode, outcome) after an event at the state ``y``."""
        q = kernels.reset(ALIGNMENT_EVENTS, which, State(*y.tolist()), self.p, mode)
        declared = ALIGNMENT.declared
        after, outcome, _ = kernels.transition(
            ALIGNMENT_EVENTS, which, time, q, self.p, mode, declared
        )
        return np.array(q), after, outcome
