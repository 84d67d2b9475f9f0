"""Many parameter sets at once, over the cores."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from model.engines.batch.scheduling import integrate_all, new_many
from model.engines.queue import Queue, new_queue
from model.engines.results import KINDS, RESULTS, Results, RunResult
from model.engines.scalar.loop import TRACK_COLUMNS, integrate_each, new_single
from model.engines.scalar.tableaux import DOP853
from model.physics.parameters import Batch, Parameters, described
from model.physics.readings import Readings
from model.runs.errors import Array, Run, estimate
from model.runs.settings import Settings, settings_with

NO_TRACK = np.empty((0, TRACK_COLUMNS))


@dataclass(frozen=True, kw_only=True)
class Alignments(
    Results[
        NDArray[np.int8],
        NDArray[np.int8],
        NDArray[np.float64],
        NDArray[np.int64],
        NDArray[np.bool_],
    ]
):
    """Results of a batch; every array has shape (n,), in the order of the batch, dimensionless.

    See ``Settings.alignment_only`` for results that are NaN with it.
    """

    def __len__(self) -> int:
        return int(self.outcome.size)


Alignments.__doc__ = described(Alignments.__doc__, RESULTS)

Engine = Literal["lanes", "scalar"]


def _filling(fill: Callable[[Array, Array, Queue, Array], None], cores: int) -> Run:
    """The engine whose kernel writes a row of endings, the last argument, for every row it takes.

    It takes them from the queue, the argument before, which the kernels of all ``cores`` share:
    they hold no lock of the interpreter.
    """

    def run(rows: Array, tolerances: Array) -> Array:
        endings = np.empty((len(rows), len(RunResult._fields)))
        threads = max(1, min(cores, len(rows)))
        queue = new_queue(len(rows), threads)
        if threads == 1:
            fill(rows, tolerances, queue, endings)
            return endings
        with ThreadPoolExecutor(threads) as pool:
            shares = [pool.submit(fill, rows, tolerances, queue, endings) for _ in range(threads)]
        for share in shares:
            share.result()
        return endings

    return run


def each_by_itself(settings: Settings, track: Array = NO_TRACK, cores: int = 1) -> Run:
    """The reference engine: one run at a time. ``track`` as in ``integrate_each``: one core."""

    def fill(rows: Array, tolerances: Array, queue: Queue, endings: Array) -> None:
        single = new_single(settings.method.method)
        integrate_each(rows, tolerances, *settings.for_kernels, track, queue, endings, single)

    return _filling(fill, cores)


def _is_usual(settings: Settings) -> bool:
    """Return whether the batch engine holds: consistent readings and the method DOP853."""
    return settings.readings == Readings.consistent() and settings.method is DOP853


def side_by_side(settings: Settings, cores: int = 1) -> Run:
    """The batch engine: many runs at a time."""
    declared, method, control = settings.for_kernels

    def fill(rows: Array, tolerances: Array, queue: Queue, endings: Array) -> None:
        many = new_many(settings.may_settle)
        integrate_all(rows, tolerances, declared, method, control, queue, endings, many)

    return _filling(fill, cores)


def _engine(name: Engine | None, settings: Settings, cores: int) -> Run:
    if name not in (None, *get_args(Engine)):
        raise ValueError(
            f"engine = {name!r}: must be 'lanes', 'scalar', or None for the fastest that fits"
        )
    if name == "scalar" or (name is None and not _is_usual(settings)):
        return each_by_itself(settings, cores=cores)
    if not _is_usual(settings):
        raise ValueError(
            f"engine = {name!r}: needs the consistent readings and the method DOP853; "
            "choose 'scalar', or None for the fastest one that fits"
        )
    return side_by_side(settings, cores)


def run_once(batch: Batch, settings: Settings, *, cores: int = 1) -> dict[str, Array]:
    """Run every parameter set once, without an estimate of its error.

    Half the cost of ``align``, for statistics over many sets. Returns the fields of ``RunResult``,
    each of shape (n,).
    """
    rows = batch.constants(settings.readings)
    run = _engine(None, settings, cores)
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
    """Run every parameter set of ``batch`` to its end.

    Each result depends on its own parameter set only: ``align(batch)`` at row i is to the bit
    ``align([batch[i]])``, whatever the order and the number of cores.

    Args:
        batch: a ``Batch``, or a sequence of ``Parameters``.
        settings: how to run.
        cores: threads to use, all by default.
        engine: "scalar" is the reference engine, one set at a time by Runge-Kutta steps. "lanes" is
            the batch engine, many sets at a time by Taylor series, for the consistent readings and
            the method DOP853 only. By default "lanes" where it fits, else "scalar". The two agree
            to their error estimates.
        **changes: fields of ``Settings`` by name, over those of ``settings`` (``horizon=100``).

    Raises:
        ValueError: an empty batch, fewer than one core, an engine that does not fit, or a setting
            outside its range.
    """
    settings = settings_with(settings, changes)
    rows_of = batch if isinstance(batch, Batch) else Batch.stack(batch)
    if len(rows_of) == 0:
        raise ValueError("the batch is empty: give at least one parameter set")
    cores = os.cpu_count() or 1 if cores is None else cores
    if cores < 1:
        raise ValueError(f"cores = {cores!r}: must be >= 1")
    run = _engine(engine, settings, cores)
    found = estimate(run, rows_of.constants(settings.readings), settings.tolerance)
    columns = found.columns()
    return Alignments(**{name: columns[name].astype(KINDS[name].array) for name in RESULTS})
