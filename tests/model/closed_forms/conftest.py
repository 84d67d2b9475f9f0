"""Runs of the engine from any state, on parts that reduce to a closed form.

The parameters reduce the part: without friction, flat and with the edge A1 under its mass centre it
is a ball; with an immense inertia it cannot tilt; a weak spring that is relaxed far away pulls it
with a constant force.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pytest

from model.engine.record import AT, MODE, STATE
from model.events.kernels import in_kernels
from model.events.outcomes import Outcome, Reason
from model.events.transitions import CONTINUES
from model.physics.modes import CLOSED, OPEN, START, Mode
from model.physics.notation import State
from model.physics.parameters import Shape
from tests.model.engine.steps import OneRun
from vibralign import ALIGNMENT, Batch, Parameters, Scene, Variants

LOCKED = 1e12
"""An inertia so large that no moment of these scenes turns the part."""


class Step(NamedTuple):
    """A step of the engine: time, state and mode before it, and after the event at its end."""

    time: float
    state: np.ndarray
    mode: Mode
    end: float
    end_state: np.ndarray
    end_mode: Mode


class SteppedRun:
    """A run from any state, by default from the start, with every step of the engine.

    ``changes`` set constants to values that the rules of parameters refuse. With ``tau_align`` the
    run starts in the slot.
    """

    def __init__(
        self,
        parameters: Parameters,
        state: np.ndarray | None = None,
        mode: Mode = START,
        *,
        horizon: float,
        tolerance: float = 1e-12,
        until: Callable[["SteppedRun"], bool] = lambda _: False,
        scene: Scene = ALIGNMENT,
        tau_align: float = np.nan,
        shape: Shape = "square",
        **changes: float,
    ) -> None:
        row = Batch.stack([parameters]).constants(Variants.consistent())[0]
        events = in_kernels(scene, shape == "round")
        self.p = events.events.constants(*row.tolist())._replace(**changes)
        self.parameters, self.steps = parameters, []
        # Only in the slot may a run settle.
        run = OneRun(
            self.p, scene, tolerance=tolerance, horizon=horizon, settles=scene is not ALIGNMENT
        )
        runs = run.memory.runs
        if state is not None:
            run.put(state, mode)
            runs[0, AT.tau_align] = tau_align
        begun = _present(runs)
        while runs[0, AT.outcome] == CONTINUES:
            run.advance()
            ended = _present(runs)
            self.steps.append(Step(*begun, *ended))
            begun = ended
            if until(self):
                break
        self.outcome, self.reason = runs[0, AT.outcome], Reason(int(runs[0, AT.reason]))
        if self.outcome != CONTINUES:
            self.outcome = Outcome(int(self.outcome))
        self.tau_align = runs[0, AT.tau_align]

    @property
    def time(self) -> np.ndarray:
        return np.array([self.steps[0].time] + [step.end for step in self.steps])

    @property
    def state(self) -> np.ndarray:
        return np.array([self.steps[0].state] + [step.end_state for step in self.steps])

    def mode_changes(self, field: str, was, becomes) -> list[Step]:
        """The steps at whose end ``field`` of the mode goes from ``was`` to ``becomes``."""
        return [
            step
            for step in self.steps
            if getattr(step.mode, field) == was and getattr(step.end_mode, field) == becomes
        ]

    def impacts(self) -> list[Step]:
        """The steps that end as A1 meets the bottom face."""
        return [
            step for step in self.steps
            if step.mode.face == OPEN and step.end_mode.face == CLOSED
        ]  # fmt: skip

    def places(self, step: Step, fractions: np.ndarray) -> list[tuple[float, State]]:
        """(time, state) at fractions of a step, by its series."""
        taken, length = OneRun(self.p), step.end - step.time
        taken.put(step.state, step.mode, step.time)
        made = taken.step(length)
        assert made >= length * (1.0 - 1e-9)
        return [
            (step.time + theta * length, State(*taken.at(theta * length / made)))
            for theta in fractions
        ]


def _present(runs) -> tuple[float, np.ndarray, Mode]:
    mode = runs[0, MODE : MODE + len(Mode._fields)]
    return runs[0, AT.time], runs[0, STATE : STATE + 6].copy(), _mode(mode.tobytes())


@lru_cache
def _mode(stored: bytes) -> Mode:
    kinds = zip(Mode.__annotations__.values(), np.frombuffer(stored), strict=True)
    return Mode(*(kind(value) for kind, value in kinds))


@pytest.fixture(scope="session")
def stepped_run():
    return SteppedRun


@pytest.fixture(scope="session")
def ball(device):
    """Parameters of a ball: the flat part over A1, on a base of given stiffness and damping.

    Without friction, and with the edge right under the mass centre, no moment and no lateral force
    ever arises.
    """

    def make(stiffness, damping, **changes):
        bare = {
            "lateral_stiffness": 0.0, "tilt_stiffness": 0.0, "lateral_damping": 0.0,
            "axial_damping": 0.0, "tilt_damping": 0.0, "friction": 0.0, "press_force": 0.0,
            "frequency": 0.0, "phase": 0.0, "initial_tilt": 0.0,
            "misalignment": device.slot_half_width,
        }  # fmt: skip
        return device.replace(
            **bare | changes, contact_stiffness=stiffness, contact_damping=damping
        )

    return make


@pytest.fixture(scope="session")
def at(device):
    """State of a ball at ``height`` above the base, with a velocity upward."""

    def make(height, velocity=0.0):
        return np.array(
            [device.slot_half_width, device.half_height + height, 0.0, 0.0, velocity, 0.0]
        )

    return make
