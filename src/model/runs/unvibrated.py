"""The unvibrated control of a run: the same part pressed the same way, but not vibrated.

A run is vibratory alignment if its control comes to rest on the edge A1 (paper, sect. 1: the part
"gets tilted and takes stable equilibrium position"; then vibration moves it). The control is
pressed as suddenly as the run, or lowered as fast. A part that falls in only because it overshoots
would rest under a slow press: ``slow_tilt`` gives the tilt of that rest.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.engine.record import constants_in
from model.engine.results import RunResult
from model.events.outcomes import UNVIBRATED_TEXT, Outcome, Unvibrated
from model.physics.approach import Start
from model.physics.parameters import Batch, Parameters
from model.physics.rest import rest_under_press
from model.physics.variants import Variants
from model.runs.engine import Array, engine_for
from model.runs.settings import Settings


class UnvibratedEnds(NamedTuple):
    """Ends of unvibrated runs: arrays of shape (n,).

    Attributes:
        outcome: values of ``Unvibrated``. A part ``RESTS`` if it comes to rest with A1 on its
            bottom face as the only contact. A part that neither rests nor aligns ``LEAVES``: it
            leaves the scene, leans on A2 as well, or does not come to rest within the horizon.
        tilt: tilt of the rest in radians; NaN unless the part rests.
    """

    outcome: NDArray[np.int8]
    tilt: Array


def unvibrated_sets(batch: Batch) -> Batch:
    """Return the sets of ``batch`` without excitation."""
    still = np.zeros(len(batch))
    return Batch({**batch.values, "frequency": still, "phase": still})


def unvibrated(batch: Batch, settings: Settings, cores: int = 1) -> UnvibratedEnds:
    """Run the sets of ``batch`` without excitation: pressed at once, or as they are lowered.

    Sets that differ only in their excitation are run once. ``settings`` are those of the vibrated
    runs; within their horizon the part must come to rest.
    """
    start: Start = "still" if settings.start in ("running", "still") else "simultaneous"
    settings = replace(settings, start=start, insertion_depth=None, alignment_only=True)
    controls = settings.rows(unvibrated_sets(batch))
    rows, which = np.unique(controls, axis=0, return_inverse=True)
    run = engine_for(settings, cores)
    found = RunResult(*run(rows, np.full(len(rows), settings.tolerance)).T)
    rests = (found.outcome == Outcome.SETTLED) & (found.end_on_edge == 1.0) & (found.end_tilt > 0.0)
    ends = np.where(rests, Unvibrated.RESTS, Unvibrated.LEAVES)
    ends = np.where(found.outcome == Outcome.ALIGNED, Unvibrated.ALIGNS, ends).astype(np.int8)
    which = which.reshape(-1)
    return UnvibratedEnds(ends[which], np.where(rests, found.end_tilt, np.nan)[which])


def unvibrated_results(batch: Batch, settings: Settings, cores: int = 1) -> dict[str, NDArray[Any]]:
    """Return the results in ``UNVIBRATED_CONTROL`` of the sets of ``batch``, each of shape (n,)."""
    found, tilts = unvibrated(batch, settings, cores), np.full(len(batch), np.nan)
    if settings.readings == Variants.consistent():  # physics/rest.py has no printed variants
        scene, _ = settings.for_kernels
        _rests(scene.events, batch.constants(settings.readings), tilts)
    return {"unvibrated": found.outcome, "unvibrated_tilt": found.tilt, "slow_tilt": tilts}


def unvibrated_words(parameters: Parameters, settings: Settings) -> str:
    """Return the end of the unvibrated control in words: "rests on the edge, tilted by 1.2°"."""
    found = unvibrated_results(Batch.stack([parameters]), settings)
    outcome, tilt, slow = (column[0] for column in found.values())
    words = UNVIBRATED_TEXT[Unvibrated(outcome)]
    if outcome == Unvibrated.RESTS:
        words += f", tilted by {np.degrees(tilt):.2g}°"
    elif np.isfinite(slow):
        words += f"; pressed slowly it rests, tilted by {np.degrees(slow):.2g}°"
    return words


@kernel
def _rest_of_each(events, rows, tilts):
    """Write the tilts of parts that rest under a slow press into ``tilts``."""
    for row in range(rows.shape[0]):
        rest = rest_under_press(constants_in(events, rows[row]))
        if rest.found:
            tilts[row] = rest.tilt


_rests = compiled(_rest_of_each)
