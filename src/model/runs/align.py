"""Alignment of many parameter sets, on several cores."""

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engine.results import RESULTS, VALUE_TYPES, Results, RunResult, results_table
from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.physics.tables import described
from model.runs.engine import Array, engine_for
from model.runs.errors import estimate
from model.runs.settings import Settings, settings_with


@results_table
class Alignments(
    Results[
        NDArray[np.int8],
        NDArray[np.int8],
        NDArray[np.float64],
        NDArray[np.int64],
        NDArray[np.bool_],
    ]
):
    """Results of a batch: arrays of shape (n,) in the order of the batch, dimensionless.

    With ``Settings.alignment_only`` some results are NaN.
    """

    def __len__(self) -> int:
        return int(self.outcome.size)

    def __repr__(self) -> str:
        counts = {str(each): int((self.outcome == each).sum()) for each in Outcome}
        ends = ", ".join(f"{count:,} {name}" for name, count in counts.items() if count)
        return f"<Alignments: {len(self):,} runs, {ends}; {self.sensitive.sum():,} sensitive>"


Alignments.__doc__ = described(Alignments.__doc__, RESULTS)


def run_once(batch: Batch, settings: Settings, *, cores: int = 1) -> dict[str, Array]:
    """Run every parameter set once, without an estimate of its error.

    Costs two thirds as much as ``align``; meant for statistics over many sets. Returns the fields
    of ``RunResult`` by name, each of shape (n,), dimensionless.
    """
    rows = settings.rows(batch)
    run = engine_for(settings, cores)
    results = RunResult(*run(rows, np.full(len(rows), settings.tolerance)).T)
    return dict(results._asdict())


def align(
    batch: Batch | Sequence[Parameters],
    settings: Settings | None = None,
    *,
    cores: int | None = None,
    **changes: Any,
) -> Alignments:
    """Run every parameter set of ``batch`` to its end and estimate the error of its result.

    As ``vibralign.align``, which takes any devices; its errors.
    """
    settings = settings_with(settings, changes)
    rows_of = batch if isinstance(batch, Batch) else Batch.stack(batch)
    if len(rows_of) == 0:
        raise ValueError("the batch is empty: give at least one parameter set")
    cores = os.cpu_count() or 1 if cores is None else cores
    if cores < 1:
        raise ValueError(f"cores = {cores!r}: must be >= 1")
    run, carrying = (engine_for(settings, cores, carries_error=each) for each in (False, True))
    found = estimate(run, carrying, settings.rows(rows_of), settings.tolerance, settings.horizon)
    columns = found.columns()
    return Alignments(**{name: columns[name].astype(VALUE_TYPES[name].array) for name in RESULTS})
