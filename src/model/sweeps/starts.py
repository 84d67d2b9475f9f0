"""Starts of a device: phases of the excitation and tilts at touch-down.

Neither can be controlled at touch-down. A device is *reliable* if it aligns (or goes in, in the
insertion scene) within the horizon from every start of an ensemble.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import SUCCESSES
from model.physics.parameters import Batch, Parameters
from model.runs.align import run_once
from model.runs.settings import Settings
from model.sweeps.settings import Ensemble

Starts = Sequence[Mapping[str, float]]


def tilts_and_phases(device: Parameters, ensemble: Ensemble) -> tuple[list[float], list[float]]:
    """Return the tilts and the phases of the ensemble; the first phase is the device's."""
    phases = [device.phase + 2.0 * math.pi * k / ensemble.phases for k in range(ensemble.phases)]
    return [device.initial_tilt * factor for factor in ensemble.tilts], phases


def starts_of(device: Parameters, ensemble: Ensemble) -> list[dict[str, float]]:
    """Return phase and tilt of every start: each tilt at each phase."""
    return [
        {"phase": phase, "initial_tilt": tilt}
        for tilt, phase in itertools.product(*tilts_and_phases(device, ensemble))
    ]


def every_start(
    devices: Batch,
    starts: Starts,
    settings: Settings,
    cores: int = 1,
    others: Mapping[str, NDArray[np.float64]] | None = None,
) -> dict[str, NDArray[Any]]:
    """Run all devices from all starts.

    ``others`` are further parameters that vary, by name, each of shape (devices, starts).

    Returns:
        The fields of ``RunResult``, and ``goes_in``; each of shape (devices, starts).
    """
    values = {name: np.repeat(column, len(starts)) for name, column in devices.values.items()}
    for name in starts[0].keys() & values.keys():
        values[name] = np.tile([start[name] for start in starts], len(devices))
    values |= {name: column.ravel() for name, column in (others or {}).items()}
    results = run_once(Batch(values), settings, cores=cores)
    shaped = {name: flat.reshape(len(devices), len(starts)) for name, flat in results.items()}
    return {**shaped, "goes_in": np.isin(shaped["outcome"], SUCCESSES)}
