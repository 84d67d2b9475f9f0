"""One run, step by step: for tests that look into steps, or that begin in a state of their own."""

import numpy as np

from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.engine import event_search, scheduling, workspace
from model.engine.lane_events import kind_of_mode, lane_events_of
from model.engine.lifecycle import NOISE, Control
from model.engine.record import AT, MODE, STATE, mode_of
from model.engine.scheduling import new_memory
from model.engine.series_kernels import missing_series
from model.engine.start import begin
from model.events import friction, kernels
from model.events.kernels import events_of, in_kernels
from model.events.transitions import CONTINUES
from model.physics.notation import State
from vibralign import ALIGNMENT, Scene

ALIGNMENT_EVENTS = events_of(ALIGNMENT.events)
state_at = compiled(event_search.state_at)


@compiled
@kernel
def missing_in(lanes, memory):
    kind = kind_of_mode(lanes, mode_of(memory.runs, 0))
    return missing_series(lanes, kind, False, memory.addresses)


@compiled
@kernel
def step(lanes, control, memory):
    memory.together[0] = 0
    kind = kind_of_mode(lanes, mode_of(memory.runs, 0))
    scheduling.step_together(lanes, kind, 1, control, memory)


@compiled
@kernel
def pass_step(scene, lanes, control, memory):
    scheduling.pass_step(scene, lanes, control, memory, 0, 0)


@compiled
@kernel
def first_event(lanes, memory):
    return event_search.first_event(lanes, memory.w, 0, memory.search)


class OneRun:
    """A run of the constants ``p``, from its start or from a state in a mode."""

    def __init__(
        self,
        p,
        scene: Scene = ALIGNMENT,
        *,
        tolerance=1e-12,
        horizon=1e9,
        settles=False,
        control: Control | None = None,
    ) -> None:
        self.p, self.scene = p, in_kernels(scene, p.is_round)
        self.lanes = lane_events_of(self.scene.events)
        self.memory = new_memory(self.lanes, runs=1)
        free = Control(horizon, 50_000_000, NOISE * tolerance * settles, 0.0, 0.0)
        self.control = control or free
        begin(np.array(p), tolerance, self.scene, self.control, self.memory.runs, 0)
        self.memory.runs[0, AT.next_step] = 1.0

    def put(self, state, mode, time=0.0):
        """Go on from a state in a mode."""
        run = self.memory.runs[0]
        run[AT.outcome], run[AT.reason], run[AT.time] = CONTINUES, 0.0, time
        run[STATE : STATE + 6], run[MODE : MODE + len(mode)] = state, mode

    def load(self):
        """Load the series that the next step needs."""
        while (missing := missing_in(self.lanes, self.memory)) >= 0:
            self.lanes.series.load(missing)

    def step(self, longest=None):
        """Make a step, of at most ``longest``, and return its length; the run stays before it."""
        if longest is not None:
            self.memory.runs[0, AT.next_step] = longest
        self.load()
        step(self.lanes, self.control, self.memory)
        return self.memory.w[workspace.STEP_LENGTH, 0]

    def at(self, theta):
        """The state at a fraction of the step."""
        return np.array(state_at(theta, self.memory.w, 0))

    def first_event(self):
        """(which, θ) of the first event in the step."""
        return first_event(self.lanes, self.memory)

    def advance(self):
        """Make a step, and go on to its end or to the first event in it."""
        self.step()
        pass_step(self.scene, self.lanes, self.control, self.memory)

    def held(self, y, mode):
        """The state ``y`` with sticking contacts at rest."""
        return np.array(friction.hold_sticking(State(*y.tolist()), self.p, mode))

    def pass_event(self, which, time, y, mode):
        """(state, mode, outcome) after an event at the state ``y``."""
        events = self.scene.events
        q = kernels.reset(events, which, State(*y.tolist()), self.p, mode)
        after, outcome, _ = kernels.transition(
            events, which, time, q, self.p, mode, self.scene.declared
        )
        return np.array(q), after, outcome
