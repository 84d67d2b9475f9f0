"""The engine as a function of many rows of constants, on several cores."""

import logging
from collections.abc import Callable
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.compile.entries import compiled
from model.engine import scheduling
from model.engine.lane_events import lane_events_of
from model.engine.queue import Queue, new_queue, stop
from model.engine.results import RunResult
from model.engine.scheduling import MOST_RUNS, Memory, new_memory
from model.runs.settings import Settings

Array = NDArray[np.float64]
Run = Callable[[Array, Array], Array]
"""(rows, tolerances) -> results; shapes (n, constants), (n,) and (n, fields of RunResult)."""

# Logs at level INFO how many runs of a batch have ended, and once that all have.
PROGRESS = logging.getLogger("vibralign")
_PAUSE = 0.5  # s, between two messages
_RESULTS = len(RunResult._fields)
_USUAL_TRACK = 4096  # rows; a longer one is run again with enough rows

_begin_all, _integrate_all = compiled(scheduling.begin_all), compiled(scheduling.integrate_all)


def engine_for(settings: Settings, cores: int = 1, *, carries_error: bool = False) -> Run:
    """Return the engine with these settings; each run carries its error if ``carries_error``."""
    scene, control = settings.for_kernels
    control = control._replace(carries_error=float(carries_error))
    lanes = lane_events_of(scene.events, settings.readings.switches)

    def run(rows: Array, tolerances: Array) -> Array:
        results = np.empty((len(rows), _RESULTS))
        threads = max(1, min(cores, len(rows)))

        def fill(queue: Queue) -> None:
            memory = new_memory(lanes, settings.may_settle, -(-len(rows) // threads))
            _integrate(rows, tolerances, scene, lanes, control, queue, results, memory)

        in_threads(fill, len(rows), threads)
        return results

    return run


def _integrate(*arguments: Any) -> None:
    """Run the sets of a queue with the ``arguments`` of ``integrate_all``; load what they need."""
    _, _, _, lanes, *_ = arguments
    _begin_all(*arguments)
    while (missing := _integrate_all(*arguments)) >= 0:
        lanes.series.load(missing)


def run_alone(
    row: Array, tolerance: float, settings: Settings, rows: int = 0, *, carries_error: bool = False
) -> tuple[RunResult, Memory]:
    """Run one row of constants once, with a track of ``rows``; return also the memory at its end.

    A track keeps its first rows; ``RunResult.tracked`` is the number that it would need.
    """
    scene, control = settings.for_kernels
    control = control._replace(carries_error=float(carries_error))
    lanes = lane_events_of(scene.events, settings.readings.switches)
    memory, results = new_memory(lanes, settings.may_settle, 1, rows), np.empty((1, _RESULTS))
    given = row[np.newaxis], np.array([tolerance]), scene, lanes, control
    in_threads(lambda queue: _integrate(*given, queue, results, memory))
    return RunResult(*results[0].tolist()), memory


def run_tracked(
    row: Array, tolerance: float, settings: Settings, *, carries_error: bool = False
) -> tuple[RunResult, Array]:
    """Run one row of constants once; return also its track, shape (rows, columns).

    Times of runs that carry their error and of others differ in their last bits.
    """
    given = row, tolerance, settings
    found, memory = run_alone(*given, _USUAL_TRACK, carries_error=carries_error)
    if found.tracked > _USUAL_TRACK:
        found, memory = run_alone(*given, int(found.tracked), carries_error=carries_error)
    return found, memory.track[: int(found.tracked)]


def in_threads(work: Callable[[Queue], None], waiting: int = 1, threads: int = 1) -> None:
    """Call ``work`` in each of ``threads`` with one queue of ``waiting`` runs, and wait for all.

    Kernels release the global interpreter lock. Progress is told meanwhile; an interrupt, or an
    error in one thread, stops them all after their present step, or when they are compiled, and
    does not wait for them.
    """
    queue, told = new_queue(waiting, threads), PROGRESS.isEnabledFor(logging.INFO)
    at_once = threads * min(int(queue[1]), MOST_RUNS)  # a run that ends takes the next number
    pool = ThreadPoolExecutor(threads)
    try:
        shares = [pool.submit(work, queue) for _ in range(threads)]
        while (now := wait(shares, _PAUSE if told else None, FIRST_EXCEPTION)).not_done:
            for share in now.done:
                share.result()
            PROGRESS.info("%d of %d runs", min(max(queue[0] - at_once, 0), waiting - 1), waiting)
    except BaseException:
        stop(queue)
        raise
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    for share in shares:
        share.result()
    PROGRESS.info("%d of %d runs", waiting, waiting)
