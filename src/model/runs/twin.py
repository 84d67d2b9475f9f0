"""The unvibrated twin of a run: the same part pressed the same way, but not vibrated.

A run is vibratory alignment if its twin comes to rest on the edge A1 (paper, sect. 1: the part
"gets tilted and takes stable equilibrium position"; then vibration moves it).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.engines.results import RunResult
from model.events.outcomes import Outcome, Unvibrated
from model.physics.parameters import Batch
from model.runs.engines import engine_for
from model.runs.settings import Settings

Array = NDArray[np.float64]


class Unvibrations(NamedTuple):
    """Ends of unvibrated runs: arrays of shape (n,).

    Attributes:
        outcome: values of ``Unvibrated``. A part ``RESTS`` if it comes to rest with A1 on its
            bottom face as the only contact; ``LEAVES`` is all else that does not align: it leaves
            the scene, leans on A2 as well, or does not come to rest within the horizon.
        tilt: tilt of the rest in radians; NaN unless the part rests.
    """

    outcome: NDArray[np.int8]
    tilt: Array


def unvibrated(batch: Batch, settings: Settings, cores: int = 1) -> Unvibrations:
    """Run the parameter sets of ``batch`` without excitation; equal ones are run once.

    Args:
        batch: the vibrated runs.
        settings: of the runs; the horizon must leave the part the time to come to rest.
        cores: number of threads.
    """
    still = np.zeros(len(batch))
    twins = Batch({**batch.values, "frequency": still, "phase": still})
    rows, which = np.unique(twins.constants(settings.readings), axis=0, return_inverse=True)
    run = engine_for(settings, cores=cores)
    found = RunResult(*run(rows, np.full(len(rows), settings.tolerance)).T)
    rests = (found.outcome == Outcome.SETTLED) & (found.end_on_edge == 1.0) & (found.end_tilt > 0.0)
    ends = np.where(rests, Unvibrated.RESTS, Unvibrated.LEAVES)
    ends = np.where(found.outcome == Outcome.ALIGNED, Unvibrated.ALIGNS, ends).astype(np.int8)
    which = which.reshape(-1)
    return Unvibrations(ends[which], np.where(rests, found.end_tilt, np.nan)[which])
