"""Coarse figures of many candidates at once.

All trajectories of all candidates are one batch, so that no lane of the batch engine idles. Each is
run once: an estimated error of every point would double the cost and decide nothing here.
"""

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.engines.results import RESULTS, RunResult
from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS, Batch
from model.physics.readings import Readings
from model.runs.engines import batch_engine, scalar_engine
from model.runs.simulate import simulate_once
from model.runs.twin import unvibrated
from model.study.claims.runs import COURSED, course_variables
from model.study.identification.candidate import Space
from model.study.sweeps import Sweep

Array = NDArray[np.float64]
_NAMES = tuple(FIELDS)
_STORED = [name for name, each in RESULTS.items() if each.stored and not each.estimated]


def datasets_of(space: Space, points: Array, names: Sequence[str]) -> list[dict[str, xr.Dataset]]:
    """Return coarse figures and own runs of candidates, with the variables that claims read.

    Args:
        space: of the candidates.
        points: shape (m, n).
        names: figures and own runs.
    """
    sweeps = [{name: space.sweep(point, name) for name in names} for point in points]
    batched = _grids(
        space, [sweep for each in sweeps for sweep in each.values() if _is_grid(sweep)]
    )
    found = [
        {
            name: next(batched) if _is_grid(sweep) else _with_courses(sweep)
            for name, sweep in each.items()
        }
        for each in sweeps
    ]
    _add_twins(
        space,
        [
            (sweep, name, datasets)
            for each, datasets in zip(sweeps, found, strict=True)
            for name, sweep in each.items()
            if name in space.figures
        ],
    )
    return found


def _add_twins(space: Space, made: Sequence[tuple[Sweep, str, dict[str, xr.Dataset]]]) -> None:
    """Add the unvibrated twins of figures' points that align; others count as not run."""
    aligned = [
        np.ravel(found[name]["outcome"].values) == Outcome.ALIGNED for _, name, found in made
    ]
    batches = [
        sweep.batch(np.flatnonzero(flags)) if sweep.dimensions else Batch.stack([sweep.baseline])
        for (sweep, _, _), flags in zip(made, aligned, strict=True)
        if flags.any()
    ]
    twins = np.empty((2, 0))
    if batches:
        values = {name: np.concatenate([each.values[name] for each in batches]) for name in _NAMES}
        twins = np.array(unvibrated(Batch(values), space.at_rest.settings), dtype=np.float64)
    ends = np.cumsum([int(flags.sum()) for flags in aligned])[:-1]
    parts = np.split(twins, ends, axis=1)
    for (_, name, found), flags, part in zip(made, aligned, parts, strict=True):
        like = found[name]["outcome"]
        both = np.full((2, flags.size), math.nan)
        both[:, flags] = part
        found[name] = found[name].assign(
            unvibrated=(like.dims, both[0].reshape(like.shape)),
            unvibrated_tilt=(like.dims, both[1].reshape(like.shape)),
        )


def _is_grid(sweep: Sweep) -> bool:
    """Return whether the results of a sweep's runs are enough for the claims."""
    return bool(sweep.dimensions) and sweep.figure not in COURSED


def _grids(space: Space, sweeps: Sequence[Sweep]) -> Iterator[xr.Dataset]:
    """Yield the dataset of each sweep; all are run as one batch."""
    if not sweeps:
        return
    settings = space.settings.settings
    sizes = [math.prod(sweep.shape) for sweep in sweeps]
    rows = np.concatenate(
        [
            sweep.batch(np.arange(size)).constants(settings.readings)
            for sweep, size in zip(sweeps, sizes, strict=True)
        ]
    )
    fast = settings.readings == Readings.consistent()
    run = batch_engine(settings) if fast else scalar_engine(settings)
    results = np.empty((len(rows), len(RunResult._fields)))
    # In a drawn order the long runs do not come together, and few lanes idle at the end.
    order = np.random.default_rng(0).permutation(len(rows))
    results[order] = run(rows[order], np.full(len(rows), settings.tolerance))
    parts = np.split(results, np.cumsum(sizes)[:-1])
    for sweep, part in zip(sweeps, parts, strict=True):
        yield _grid(sweep, dict(zip(RunResult._fields, part.T, strict=True)))


def _grid(sweep: Sweep, results: Mapping[str, Array]) -> xr.Dataset:
    names = [dimension.parameter for dimension in sweep.dimensions]
    columns = {name: (names, results[name].reshape(sweep.shape)) for name in _STORED}
    columns["sensitive"] = (names, np.zeros(sweep.shape, dtype=np.int8))
    held = {name: ((), value) for name, value in _held(sweep).items() if name not in names}
    along = {each.parameter: (each.parameter, np.array(each.values)) for each in sweep.dimensions}
    return xr.Dataset({**columns, **held, **along})


def _held(sweep: Sweep) -> dict[str, float]:
    return {name: math.nan if value is None else value for name, value in sweep.parameters.items()}


def _with_courses(sweep: Sweep) -> xr.Dataset:
    """The dataset of a sweep whose claims read trajectories: a history, or an own run."""
    settings = sweep.settings.settings
    if not sweep.dimensions:
        run = simulate_once(sweep.baseline, settings)
        scalars = {name: float(getattr(run, name)) for name in _STORED}
        columns = {name: ("time", values) for name, values in run.course.items()}
        held = {**scalars, **_held(sweep), "sensitive": 0}
        return xr.Dataset(
            {**columns, **{name: ((), value) for name, value in held.items()}},
            {"time": ("time", run.time)},
        )
    size = math.prod(sweep.shape)
    batch = sweep.batch(np.arange(size))
    runs = [simulate_once(batch[row], settings) for row in range(size)]
    stored = {name: np.array([float(getattr(run, name)) for run in runs]) for name in _STORED}
    return _grid(sweep, stored).assign(course_variables(sweep, runs))
