"""Starts of an ensemble: phases of the excitation and initial tilts at touch-down.

Neither can be controlled: a *reliable* device aligns within the horizon from every start.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.align import run_once
from model.runs.settings import Settings
from model.study.config import Ensemble

Starts = Sequence[Mapping[str, float]]


def starts_of(device: Parameters, ensemble: Ensemble) -> list[dict[str, float]]:
    """Return phase and tilt of every start of the ensemble; the first is the device's own."""
    phases = [device.phase + 2.0 * math.pi * k / ensemble.phases for k in range(ensemble.phases)]
    tilts = [device.initial_tilt * factor for factor in ensemble.tilts]
    return [
        {"phase": phase, "initial_tilt": tilt} for tilt, phase in itertools.product(tilts, phases)
    ]


@dataclass(frozen=True)
class FromEveryStart:
    """Results of devices from every start, one run each.

    Attributes:
        aligned: True where a run aligns, shape (devices, starts).
        tau_align: alignment time, NaN where a run does not align, same shape.
        rhs_evaluations: sum over the starts, shape (devices,).
    """

    aligned: NDArray[np.bool_]
    tau_align: NDArray[np.float64]
    rhs_evaluations: NDArray[np.int64]

    @property
    def reliable(self) -> NDArray[np.bool_]:
        """Devices that align from every start, shape (devices,)."""
        found: NDArray[np.bool_] = np.logical_and.reduce(self.aligned, axis=1)
        return found

    @property
    def tau_worst(self) -> NDArray[np.float64]:
        """Longest duration of a reliable device, NaN of another; shape (devices,)."""
        found: NDArray[np.float64] = self.tau_align.max(axis=1)
        return found


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


def from_every_start(
    device: Parameters,
    swept: Mapping[str, NDArray[np.float64]],
    starts: Starts,
    settings: Settings,
    cores: int = 1,
) -> FromEveryStart:
    """Run ``device`` with the parameters ``swept``, each of shape (devices,), from every start.

    Raises:
        ValueError: as ``Batch.of``.
    """
    settings = settings.quickest
    found = every_start(Batch.of(device, **swept), starts, settings, cores)
    return FromEveryStart(
        aligned=found["goes_in"],
        tau_align=np.where(found["goes_in"], found["tau_align"], np.nan),
        rhs_evaluations=found["rhs_evaluations"].sum(axis=1).astype(np.int64),
    )
