"""The queue of parameter sets that threads share."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.engine.queue import fair_share, new_queue, next_in


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
