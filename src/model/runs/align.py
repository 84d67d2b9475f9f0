"""Alignment of many parameter sets, on several cores."""

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.engines.results import RESULTS, VALUE_TYPES, Results, RunResult, results_table
from model.physics.parameters import Batch, Parameters
from model.physics.tables import described
from model.runs.engines import Array, Engine, engine_for, error_carrying_engine
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


Alignments.__doc__ = described(Alignments.__doc__, RESULTS)


def run_once(batch: Batch, settings: Settings, *, cores: int = 1) -> dict[str, Array]:
    """Run every parameter set once, without an estimate of its error.

    Costs two thirds as much as ``align``; meant for statistics over many sets. Returns the fields
    of ``RunResult`` by name, each of shape (n,), dimensionless.
    """
    rows = settings.rows(batch)
    run = engine_for(settings, cores=cores)
    results = RunResult(*run(rows, np.full(len(rows), settings.tolerance)).T)
    return dict(results._asdict())


def align(
    batch: Batch | Sequence[Parameters],
    settings: Settings | None = None,
    *,
    cores: int | None = None,
    engine: Engine | None = None,
    **changes: Any,
) -> Alignments:
    """Run every parameter set of ``batch`` to its end and estimate the error of its result.

    Each result depends on its own parameter set only: row i of ``align(batch)`` equals
    ``align([batch[i]])`` to the bit, for any order and any number of cores.

    Args:
        batch: a ``Batch``, or a sequence of ``Parameters``.
        settings: settings of the runs; the defaults of ``Settings`` if None.
        cores: number of threads, >= 1; all cores by default.
        engine: "scalar" is the reference engine, one set at a time by Runge-Kutta steps. "batch" is
            the batch engine, many sets at a time by Taylor series; it needs the consistent
            readings. By default "batch" where it fits, else "scalar". Results of the two agree
            within their error estimates.
        **changes: fields of ``Settings`` by name, over those of ``settings`` (``horizon=100``).

    Raises:
        TypeError: no batch and no sequence of ``Parameters``, or a setting of the wrong type.
        ValueError: an empty batch, fewer than one core, an engine that does not fit, or a setting
            that is unknown or out of range.
    """
    settings = settings_with(settings, changes)
    rows_of = batch if isinstance(batch, Batch) else Batch.stack(batch)
    if len(rows_of) == 0:
        raise ValueError("the batch is empty: give at least one parameter set")
    cores = os.cpu_count() or 1 if cores is None else cores
    if cores < 1:
        raise ValueError(f"cores = {cores!r}: must be >= 1")
    run = engine_for(settings, engine, cores)
    carrying = error_carrying_engine(settings, engine, cores)
    columns = estimate(run, settings.rows(rows_of), settings.tolerance, carrying).columns()
    return Alignments(**{name: columns[name].astype(VALUE_TYPES[name].array) for name in RESULTS})
