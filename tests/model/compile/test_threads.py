"""Threads: calls run at once, and kernels are compiled once."""

import errno
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import numpy as np
import pytest

from model.compile.entries import compiled
from tests.model.compile.sources import load

THREADS = 8
MEETING = """\
@kernel
def meets(places, mine, other, patience):
    fetch_add(places[mine:], 1)
    for n in range(patience):
        if fetch_add(places[other:], 0) != 0:
            return True
    return False
"""


def test_two_calls_run_at_the_same_time() -> None:
    meets = compiled(load(MEETING).meets)
    assert not meets(np.zeros(2, np.int64), 0, 1, 10)
    places = np.zeros(2, np.int64)
    with ThreadPoolExecutor(2) as pool:
        # Each waits for the other: some seconds at most, so that a test that fails ends.
        calls = [pool.submit(meets, places, n, 1 - n, 500_000_000) for n in (0, 1)]
        assert [each.result() for each in calls] == [True, True]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("is_written", [True, False])
def test_threads_that_call_a_kernel_first_compile_it_once(
    is_written: bool, made: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_path: Path, _content: bytes) -> int:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    if not is_written:
        monkeypatch.setattr(Path, "write_bytes", refuse)
    module = load("@separate_kernel\ndef part(x):\n    return x + 1\n\n\n"
                  "@kernel\ndef called(x):\n    return part(x) * 2\n")  # fmt: skip
    together, called = Barrier(THREADS), compiled(module.called)

    def call(n: int) -> int:
        together.wait()
        return called(n)

    with ThreadPoolExecutor(THREADS) as pool:
        assert [*pool.map(call, range(THREADS))] == [2 * (n + 1) for n in range(THREADS)]
    assert len(made) == 2
