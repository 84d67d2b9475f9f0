"""Parameter sets that wait for their run, for all threads: each takes the next when it has room."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from model.physics.compiled import kernel

Queue = NDArray[np.int64]


def new_queue(waiting: int, threads: int) -> Queue:
    """Return what all ``threads`` share, shape (2,): next row, and a thread's fair share."""
    return np.array([0, -(-waiting // threads)], dtype=np.int64)


@intrinsic
def _added_one(_context: Any, queue: Any) -> Any:
    """Add one to the first of an array's numbers, at once for all threads: what it was before."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        one = ir.Constant(ir.IntType(64), 1)
        return builder.atomic_rmw("add", array.data, one, "monotonic")

    return types.int64(queue), generate


@kernel
def next_in(queue):
    """The row of the next parameter set; beyond the last when none waits."""
    return _added_one(queue)  # type: ignore[call-arg]


@kernel
def fair_share(queue):
    """Return how many sets a thread may have under way, so that others find some, too."""
    return queue[1]
