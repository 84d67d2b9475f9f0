"""Steps of DOP853 in the alignment scene, for tests that take them one at a time."""

import numpy as np

from model import ALIGNMENT
from model.compile.entries import compiled
from model.engines.scalar import location, step
from model.engines.scalar.location import NODES
from model.engines.scalar.tableaux import DOP853
from model.events import kernels
from model.events.kernels import MOST_SAMPLES, events_of

ALIGNMENT_EVENTS = events_of(ALIGNMENT.events)
first_event, sample_step = compiled(location.first_event), compiled(location.sample_step)
dense_output, interpolate, right_hand_side, state_of, take_step = map(
    compiled,
    (step.dense_output, step.interpolate, step.right_hand_side, step.state_of, step.take_step),
)
level = compiled(kernels.level)


class Steps:
    """The engine's functions of one step, with the arrays that they fill."""

    def __init__(self, p):
        self.p = p
        stages, degree = DOP853.dense.shape
        self.k, self.end, self.trial = np.empty((stages, 6)), np.empty(6), np.empty(6)
        self.dense = np.empty((6, degree))
        self.nodes, self.samples = np.empty((NODES, 6)), np.empty((NODES, MOST_SAMPLES))

    def step(self, time, h, y, mode):
        """The state after a step of length ``h``."""
        right_hand_side(time, y, self.p, mode, self.k[0])
        take_step(time, h, y, self.p, mode, self.k, self.end)
        return self.end.copy()

    def dense_step(self, time, h, y, mode):
        """As ``step``; fills the dense output."""
        end = self.step(time, h, y, mode)
        dense_output(time, h, y, self.p, mode, self.k, self.trial, self.dense)
        return end

    def first_event(self, time, h, y, mode):
        """(which, θ) of the first event on the dense output."""
        sample_step(
            ALIGNMENT_EVENTS, time, h, 1.0, y, self.dense, self.p, mode, self.nodes, self.samples
        )
        return first_event(ALIGNMENT_EVENTS, time, h, y, self.dense, self.p, mode, self.samples)

    def pass_event(self, which, time, y, mode):
        """(state, mode, outcome) after an event at the state ``y``."""
        q = kernels.reset(ALIGNMENT_EVENTS, which, state_of(y), self.p, mode)
        declared = ALIGNMENT.declared
        after, outcome, _ = kernels.transition(
            ALIGNMENT_EVENTS, which, time, q, self.p, mode, declared
        )
        return np.array(q), after, outcome
