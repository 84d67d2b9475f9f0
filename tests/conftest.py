"""Shared fixtures. Floating-point accidents are errors: no test may pass on a silent NaN."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from model import Batch, Parameters, Readings
from model.physics.parameters import Constants

CONSISTENT = Readings.consistent()


@pytest.fixture(autouse=True)
def _floating_point_errors() -> Iterator[None]:
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield


@pytest.fixture(scope="session")
def device() -> Parameters:
    """The structural set of physics.md at a working point that aligns."""
    return Parameters(
        half_width=1.0476,
        half_height=4.1057,
        inertia=15.434,
        lateral_stiffness=0.04793,
        tilt_stiffness=10.0,
        lateral_damping=1.5969,
        axial_damping=0.17288,
        tilt_damping=4.5182,
        friction=0.12,
        press_force=3.0,
        frequency=10.0,
    )


@pytest.fixture(scope="session")
def constants() -> Callable[..., Constants]:
    """What kernels compute with: ``constants(parameters, readings)``."""

    def make(parameters: Parameters, readings: Readings = CONSISTENT) -> Constants:
        return Constants(*Batch.stack([parameters]).constants(readings)[0].tolist())

    return make


@pytest.fixture(scope="session")
def random_states() -> Callable[..., list[np.ndarray]]:
    """Seeded states (x, y, φ, ẋ, ẏ, φ̇) around the working range, tilts of both signs."""

    def make(count: int, seed: int = 1) -> list[np.ndarray]:
        low = np.array([-1.5, 3.0, -0.9, -2.0, -2.0, -1.0])
        high = np.array([1.5, 5.0, 0.9, 2.0, 2.0, 1.0])
        return list(np.random.default_rng(seed).uniform(low, high, size=(count, 6)))

    return make
