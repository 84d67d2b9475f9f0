"""Starts of an ensemble: phases of the excitation and initial tilts at touch-down.

Neither can be controlled: a *reliable* device aligns within the horizon from every start.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.align import run_once
from model.runs.settings import Settings
from model.study.config.figures import Ensemble

Starts = Sequence[Mapping[str, float]]


def starts_of(device: Parameters, ensemble: Ensemble) -> list[dict[str, float]]:
    """Return phase and tilt of every start of the ensemble; the first is the device's own."""
    phases = [device.phase + 2.0 * math.pi * k / ensemble.phases for k in range(ensemble.phases)]
    tilts = [device.initial_tilt * factor for factor in ensemble.tilts]
    return [
        {"phase": phase, "initial_tilt": tilt} for tilt, phase in itertools.product(tilts, phases)
    ]


# Outcomes of a run in which the part goes in.
GOES_IN = (Outcome.ALIGNED, Outcome.INSERTED)


def every_start(
    devices: Batch, starts: Starts, settings: Settings, cores: int = 1
) -> dict[str, NDArray[Any]]:
    """Run every device from every start.

    Returns the fields of ``RunResult`` and ``goes_in``, each of shape (devices, starts).
    """
    values = {name: np.repeat(each, len(starts)) for name, each in devices.values.items()}
    for name in starts[0]:
        values[name] = np.tile([start[name] for start in starts], len(devices))
    found = run_once(Batch(values), settings, cores=cores)
    shaped = {name: each.reshape(len(devices), len(starts)) for name, each in found.items()}
    return {**shaped, "goes_in": np.isin(shaped["outcome"], GOES_IN)}


def are_reliable(
    device: Parameters,
    swept: Mapping[str, NDArray[np.float64]],
    starts: Starts,
    settings: Settings,
    cores: int = 1,
) -> NDArray[np.bool_]:
    """Return which devices go in from every start, shape (devices,).

    They are ``device`` with the parameters ``swept``, each of shape (devices,).

    Raises:
        ValueError: as ``Batch.of``.
    """
    found = every_start(Batch.of(device, **swept), starts, settings.quickest, cores)
    reliable: NDArray[np.bool_] = np.logical_and.reduce(found["goes_in"], axis=1)
    return reliable
