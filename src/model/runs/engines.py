"""The engines as functions of many rows of constants, on several cores."""

import logging
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from model.compile.entries import COMPILES, compiled
from model.engine import scheduling
from model.engine.lane_events import lane_events_of
from model.engine.queue import Queue, new_queue, stop
from model.engine.results import RunResult
from model.engine.scalar import loop
from model.engine.scalar.loop import TRACK_COLUMNS, new_scalar_memory
from model.engine.scheduling import new_batch_memory
from model.physics.variants import Variants
from model.runs.settings import Settings

Array = NDArray[np.float64]
Engine = Literal["batch", "scalar"]
Run = Callable[[Array, Array], Array]
"""(rows, tolerances) -> results; shapes (n, constants), (n,) and (n, fields of RunResult)."""

PROGRESS = logging.getLogger("vibralign")  # logs at level INFO how many runs of a batch are done
_PAUSE = 0.5  # s, between two messages

NO_TRACK = np.empty((0, TRACK_COLUMNS))

_integrate_each = compiled(loop.integrate_each)
_begin_all, _integrate_all = compiled(scheduling.begin_all), compiled(scheduling.integrate_all)


def scalar_engine(settings: Settings, track: Array = NO_TRACK, cores: int = 1) -> Run:
    """Return the reference engine, one run at a time; it fills ``track`` as ``integrate`` does."""

    def fill(rows: Array, tolerances: Array, queue: Queue, results: Array) -> None:
        memory = new_scalar_memory()
        _integrate_each(rows, tolerances, *settings.for_kernels, track, queue, results, memory)

    return _on_cores(fill, cores)


def batch_engine(settings: Settings, cores: int = 1, *, carries_error: bool = False) -> Run:
    """Return the batch engine: many runs at a time, each with its error if ``carries_error``."""
    scene, control = settings.for_kernels
    control = control._replace(carries_error=float(carries_error))
    lanes = lane_events_of(scene.events)

    def fill(rows: Array, tolerances: Array, queue: Queue, results: Array) -> None:
        memory = new_batch_memory(lanes, settings.may_settle)
        arguments = rows, tolerances, scene, lanes, control, queue, results, memory
        _begin_all(*arguments)
        while (missing := _integrate_all(*arguments)) >= 0:
            lanes.series.load(missing)

    return _on_cores(fill, cores)


def batch_engine_fits(settings: Settings) -> bool:
    """Return whether the batch engine can run these settings.

    It has the consistent variants only, and cannot run as Python without compilation.
    """
    return settings.readings == Variants.consistent() and COMPILES


def error_carrying_engine(
    settings: Settings, name: Engine | None = None, cores: int = 1
) -> Run | None:
    """Return the batch engine that carries the error of each run.

    None where ``engine_for`` returns the reference engine, which carries none.
    """
    if name == "scalar" or not batch_engine_fits(settings):
        return None
    return batch_engine(settings, cores, carries_error=True)


def engine_for(settings: Settings, name: Engine | None = None, cores: int = 1) -> Run:
    """Return the engine of that name, or the fastest that fits the settings.

    Raises:
        ValueError: an unknown name, or an engine that does not fit.
    """
    if name not in (None, *get_args(Engine)):
        raise ValueError(
            f"engine = {name!r}: must be 'batch', 'scalar', or None for the fastest that fits"
        )
    batch_fits = batch_engine_fits(settings)
    if name == "scalar" or (name is None and not batch_fits):
        return scalar_engine(settings, cores=cores)
    if not batch_fits:
        raise ValueError(
            f"engine = {name!r}: needs the consistent readings and compilation (no "
            "VIBRALIGN_NO_COMPILATION); choose 'scalar', or None for the fastest one that fits"
        )
    return batch_engine(settings, cores)


def _on_cores(fill: Callable[[Array, Array, Queue, Array], None], cores: int) -> Run:
    """Return the engine whose kernel ``fill`` takes rows from a queue and writes their results."""

    def run(rows: Array, tolerances: Array) -> Array:
        results = np.empty((len(rows), len(RunResult._fields)))
        threads = max(1, min(cores, len(rows)))
        in_threads(lambda queue: fill(rows, tolerances, queue, results), len(rows), threads)
        return results

    return run


def in_threads(work: Callable[[Queue], None], waiting: int = 1, threads: int = 1) -> None:
    """Call ``work`` in each of ``threads`` with one queue of ``waiting`` runs, and wait for all.

    Kernels release the global interpreter lock. Progress is told meanwhile; an interrupt, or an
    error in one thread, stops them all after their present step, or when they are compiled, and
    does not wait for them.
    """
    queue, told = new_queue(waiting, threads), PROGRESS.isEnabledFor(logging.INFO)
    pool = ThreadPoolExecutor(threads)
    try:
        shares = [pool.submit(work, queue) for _ in range(threads)]
        while (now := wait(shares, _PAUSE if told else None, FIRST_EXCEPTION)).not_done:
            for share in now.done:
                share.result()
            PROGRESS.info("%s of %s runs", f"{min(queue[0], waiting):,}", f"{waiting:,}")
    except BaseException:
        stop(queue)
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    for share in shares:
        share.result()
