"""The queue of parameter sets that threads share."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from model.compile.entries import compiled, flattened
from model.compile.kernels import kernel
from model.engine.lane_events import lane_events_of
from model.engine.queue import fair_share, new_queue, next_in
from model.engine.scheduling import new_memory
from model.runs.settings import Settings


@compiled
@kernel
def take_all(queue, waiting, taken):
    row = next_in(queue)
    while row < waiting:
        taken[row] += 1.0
        row = next_in(queue)


def test_every_row_is_taken_once_whatever_the_threads() -> None:
    waiting, threads = 2_000_000, 4
    taken, queue = np.zeros(waiting), new_queue(waiting, threads)
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(take_all, queue, waiting, taken) for _ in range(threads)]:
            done.result()
    assert (taken == 1.0).all()


@pytest.mark.parametrize(("waiting", "threads", "share"), [(7, 1, 7), (7, 2, 4), (8, 2, 4)])
def test_a_share_leaves_something_to_the_others(waiting: int, threads: int, share: int) -> None:
    assert fair_share(new_queue(waiting, threads)) == share


@pytest.mark.parametrize(("runs", "rows"), [(1, 0), (1, 5), (2, 0), (7, 0), (1_000, 0)])
def test_one_machine_code_serves_any_number_of_runs_and_rows(runs: int, rows: int) -> None:
    settings = Settings()
    scene, _ = settings.for_kernels
    lanes = lane_events_of(scene.events, settings.readings.switches)
    sets = np.ones((runs, 30))

    def type_of(*arguments: object) -> object:
        return [flattened(each, []) for each in arguments]

    usual = type_of(new_memory(lanes, True, 64), np.ones((64, 30)), np.ones(64))
    assert type_of(new_memory(lanes, True, runs, rows), sets, sets[:, 0].copy()) == usual
    one = sets[0][np.newaxis], np.array([1.0])  # a view of one row, with a stride of 0
    assert type_of(new_memory(lanes, True, 1, rows), *one) == usual
