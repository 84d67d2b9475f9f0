"""Queue of parameter sets, shared by all threads: a thread takes the next set when it has room.

An array of the next row, a thread's share of rows, and 1 once all threads shall stop.
"""

import numpy as np
from numpy.typing import NDArray

from model.compile.builtins import fetch_add
from model.compile.kernels import kernel

Queue = NDArray[np.int64]
_STOP = 2


def new_queue(waiting: int, threads: int) -> Queue:
    """Return the queue of all ``threads``, shape (3,)."""
    return np.array([0, -(-waiting // threads), 0], dtype=np.int64)


@kernel
def next_in(queue):
    """Take the next parameter set and return its row; a row beyond the last if none waits."""
    return fetch_add(queue, 1)


@kernel
def fair_share(queue):
    """Return the number of sets that a thread may run at once, so that others get some too."""
    return queue[1]


def stop(queue: Queue) -> None:
    """Make all threads stop after their present step."""
    queue[_STOP] = 1


@kernel
def is_stopped(queue):
    """Return whether another thread has said ``stop``: read at every call, not once for all."""
    return fetch_add(queue[_STOP:], 0) != 0
