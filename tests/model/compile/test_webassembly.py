"""Kernels as WebAssembly compute what Python computes."""

import ctypes
import struct

import numpy as np
import pytest

from model.compile.entries import flattened
from model.compile.webassembly import web_assembly_of
from tests.model.compile.sources import bits, load

wasmtime = pytest.importorskip("wasmtime")

KERNELS = """\
TABLE = np.array([0.5, -1.5, 2.25])


@separate_kernel
def apart(x, n):
    return x / (n + 2), n * n


@kernel
def main(x, n, flag, w, k):
    s = sqrt(abs(x)) + floor(x)
    for i in range(w.shape[0]):
        y, m = apart(w[i] + TABLE[i % 3], n)
        s += y if flag else -y
        w[i] = s
        k[i] += m // (i - 7) + int(y) + (m << 3)
    return s, n % 5 - 7, not flag, Point(abs(x) ** 0.25, n), (k[0], min(s, 1.0))
"""


def run(binary: bytes, stack: int, words: bytes, result: int, at: int) -> tuple[bytes, bytes]:
    """Return the result and the memory after the words, of a call."""
    store = wasmtime.Store()
    module = wasmtime.Module(store.engine, binary)
    memory = wasmtime.Memory(store, wasmtime.MemoryType(wasmtime.Limits(8, None)))
    imports = []
    for each in module.imports:
        if each.name == "__linear_memory":
            imports.append(memory)
        elif each.name == "__stack_pointer":
            imports.append(wasmtime.Global(store, each.type, wasmtime.Val.i32(stack)))
        else:
            function = getattr(ctypes.CDLL(None), each.name)
            function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * 2
            imports.append(wasmtime.Func(store, each.type, function))
    exported = wasmtime.Instance(store, module, imports).exports(store)
    memory.write(store, words, at)
    exported["run"](store, at, at + len(words))
    found = memory.read(store, at, at + len(words) + result)
    return bytes(found[len(words) :]), bytes(found[: len(words)])


@pytest.mark.parametrize("arguments", [(2.75, 9, True), (-0.5, -3, False), (1e9, 2**20, True)])
def test_an_entry_computes_what_python_computes(arguments: tuple[float, int, bool]) -> None:
    module = load(KERNELS)
    w, k = np.array([1.0, -2.0, 0.5, 8.0]), np.array([3, -4, 5, 7])
    types = tuple(flattened(each, []) for each in (*arguments, w, k))
    made = web_assembly_of((module.main, types))
    x, n, flag = arguments
    at = made.stack  # words, then the arrays
    arrays = at + 8 * 7
    words = struct.pack("=dqqqqqq", x, n, flag, arrays, 4, arrays + 32, 4)
    result, after = run(made.binary, made.stack, words + w.tobytes() + k.tobytes(), 8 * 8, at)
    expected = module.main(*arguments, w, k)
    found = struct.unpack("=dqqdqqqd", result)
    s, rest, is_not, point, (first, least) = expected
    numbers = float(s), int(rest), int(is_not), point.x, point.n, int(point.flag)
    assert bits(found) == bits((*numbers, int(first), float(least)))
    assert after[8 * 7 :] == w.tobytes() + k.tobytes()


def test_constants_and_the_stack_lie_apart() -> None:
    module = load(KERNELS)
    types = tuple(flattened(each, []) for each in (1.0, 2, True, np.zeros(3), np.zeros(3, int)))
    made = web_assembly_of((module.main, types))
    assert made.stack % 64 == 0
    assert made.stack >= 2**16
