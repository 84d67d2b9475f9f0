"""Figures of many devices on a coarse grid, computed as one batch and without errors."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS, Batch
from model.runs.align import run_once
from model.runs.unvibrated import unvibrated
from model.sweeps.sweep import Sweep, merge, run
from study.claims.data import Figure, Figures, figure_of

REST_HORIZON, REST_TOLERANCE = 300.0, 1e-8  # what is not vibrated must be seen to come to rest


def figures_of(devices: Sequence[Sequence[Sweep]]) -> list[Figures]:
    """Return the figures of each device from its sweeps, by name."""
    found: list[dict[str, Figure]] = [{} for _ in devices]
    pairs = [(device, each) for device, sweeps in enumerate(devices) for each in sweeps]
    for device, sweep in pairs:
        if not sweep.dimensions:
            dataset = merge(sweep, "", [run(sweep)])
            found[device][sweep.name] = figure_of(dataset.assign(sensitive=0))
    gridded = [pair for pair in pairs if pair[1].dimensions]
    if gridded:
        for (device, sweep), figure in zip(gridded, _gridded([s for _, s in gridded]), strict=True):
            found[device][sweep.name] = figure
    return list(found)


def _gridded(sweeps: Sequence[Sweep]) -> list[Figure]:
    settings = sweeps[0].settings.settings
    batches = [each.batch(np.arange(math.prod(each.shape))) for each in sweeps]
    together = Batch({n: np.concatenate([each.values[n] for each in batches]) for n in FIELDS})
    # In a drawn order the long runs do not come together, and few lanes idle at the end.
    order = np.random.default_rng(0).permutation(len(together))
    found = run_once(_rows(together, order), settings)
    back = np.argsort(order)
    columns = {name: found[name][back] for name in found}
    aligned = np.flatnonzero(columns["outcome"] == Outcome.ALIGNED)
    columns["sensitive"] = np.zeros(len(together), np.int8)
    columns["unvibrated"] = np.full(len(together), -1, np.int8)
    columns["unvibrated_tilt"] = np.full(len(together), math.nan)
    if aligned.size:
        still = replace(settings, horizon=REST_HORIZON, tolerance=REST_TOLERANCE)
        rest = unvibrated(_rows(together, aligned), still)
        columns["unvibrated"][aligned] = rest.outcome
        columns["unvibrated_tilt"][aligned] = rest.tilt
    ends = np.cumsum([len(each) for each in batches])[:-1]
    split = {name: np.split(values, ends) for name, values in columns.items()}
    return [
        Figure(
            name=sweep.name,
            kind=sweep.kind,
            axes={each.parameter: np.array(each.values) for each in sweep.dimensions},
            results={name: parts[row].reshape(sweep.shape) for name, parts in split.items()},
            held={
                name: value
                for name, value in sweep.parameters.items()
                if value is not None and name not in sweep.swept
            },
            course={},
        )
        for row, sweep in enumerate(sweeps)
    ]


def _rows(batch: Batch, rows: NDArray[np.int64]) -> Batch:
    """Return the parameter sets in some rows of a batch."""
    return Batch({name: column[rows] for name, column in batch.values.items()})
