"""Steps of DOP853 in the alignment scene, for tests that take them one at a time."""

import numpy as np

from model import ALIGNMENT
from model.compile.jit import entry_point
from model.engines.scalar import location, step
from model.engines.scalar.location import NODES
from model.engines.scalar.tableaux import DOP853
from model.events.kernels import ALIGNMENT_EVENTS, MOST_SAMPLES

first_event, sample_step = entry_point(location.first_event), entry_point(location.sample_step)
dense_output, interpolate, right_hand_side, state_of, take_step = map(
    entry_point,
    (step.dense_output, step.interpolate, step.right_hand_side, step.state_of, step.take_step),
)


class Steps:
    """The engine's functions of one step, with the arrays that they fill."""

    def __init__(self, p):
        self.p, self.method = p, DOP853.method
        stages, degree = DOP853.dense.shape
        self.k, self.end, self.trial = np.empty((stages, 6)), np.empty(6), np.empty(6)
        self.dense = np.empty((6, degree))
        self.nodes, self.samples = np.empty((NODES, 6)), np.empty((NODES, MOST_SAMPLES))

    def step(self, time, h, y, mode):
        """The state after a step of length ``h``."""
        right_hand_side(time, y, self.p, mode, self.k[0])
        take_step(time, h, y, self.p, mode, self.method, self.k, self.end)
        return self.end.copy()

    def dense_step(self, time, h, y, mode):
        """As ``step``; fills the dense output."""
        end = self.step(time, h, y, mode)
        dense_output(time, h, y, self.p, mode, self.method, self.k, self.trial, self.dense)
        return end

    def first_event(self, time, h, y, mode):
        """(which, θ) of the first event on the dense output."""
        sample_step(
            ALIGNMENT_EVENTS, time, h, 1.0, y, self.dense, self.p, mode, self.nodes, self.samples
        )
        return first_event(ALIGNMENT_EVENTS, time, h, y, self.dense, self.p, mode, self.samples)

    def pass_event(self, which, time, y, mode):
        """(state, mode, outcome) after an event at the state ``y``."""
        q = ALIGNMENT_EVENTS.reset(which, state_of(y), self.p, mode)
        declared = ALIGNMENT.declared
        after, outcome, _ = ALIGNMENT_EVENTS.transition(which, time, q, self.p, mode, declared)
        return np.array(q), after, outcome
