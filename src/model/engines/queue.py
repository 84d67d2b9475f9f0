"""Queue of parameter sets, shared by all threads: a thread takes the next set when it has room."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from model.compile.jit import config, kernel

Queue = NDArray[np.int64]


def new_queue(waiting: int, threads: int) -> Queue:
    """Return the queue of all ``threads``, shape (2,): next row, and a thread's share of rows."""
    return np.array([0, -(-waiting // threads)], dtype=np.int64)


@intrinsic
def _added_one(_context: Any, queue: Any) -> Any:
    """Add one to an array's first number atomically; return the value before."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        one = ir.Constant(ir.IntType(64), 1)
        return builder.atomic_rmw("add", array.data, one, "monotonic")

    return types.int64(queue), generate


def _added_one_in_python(queue: Queue) -> Any:
    """``_added_one`` where nothing is compiled, for one thread."""
    queue[0] += 1
    return queue[0] - 1


_take = _added_one_in_python if config.DISABLE_JIT else _added_one


@kernel
def next_in(queue):
    """Take the next parameter set and return its row; a row beyond the last if none waits."""
    return _take(queue)  # type: ignore[call-arg]


@kernel
def fair_share(queue):
    """Return the number of sets that a thread may run at once, so that others get some too."""
    return queue[1]
