"""Outcomes of aligned runs in the insertion scene: inserted, jammed, or another end."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from model.events.insertion import INSERTION
from model.events.outcomes import InsertionOutcome, Outcome
from model.physics.parameters import Batch
from model.runs.align import run_once
from model.runs.settings import Settings


def insertion_outcomes(
    batch: Batch, outcome: NDArray[np.int8], settings: Settings, cores: int = 1
) -> NDArray[np.int8]:
    """Return how the aligned runs of ``batch`` end in the insertion scene, shape (n,).

    ``outcome``, shape (n,), and ``settings`` are those of its runs in the alignment scene. Returns
    values of ``InsertionOutcome``, from one run each without an estimate of its error.
    """
    found = np.full(outcome.shape, InsertionOutcome.NOT_ALIGNED, dtype=np.int8)
    aligned = np.flatnonzero(outcome == Outcome.ALIGNED)
    if aligned.size:
        rows = Batch({name: values[aligned] for name, values in batch.values.items()})
        settings = replace(settings, scene=INSERTION, alignment_only=False)
        found[aligned] = run_once(rows, settings, cores=cores)["outcome"]
    return found
