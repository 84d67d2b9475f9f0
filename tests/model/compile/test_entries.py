"""Entries: what Python may pass and gets back, and kernels that have no source."""

import struct
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from model.compile.entries import bound, compiled
from model.compile.kernels import kernel
from model.compile.source import KernelError
from tests.model.compile.sources import bits, kernel_of, load

KERNELS = """\
@kernel
def double(x):
    return 2 * x


@kernel
def triple(x):
    return 3 * x


@kernel
def main(function, name, x):
    return function(x) + (1 if name == "a" else 0)


@kernel
def größe(x):
    return 2 * x


@separate_kernel
def μ(x):
    return größe(x)


@kernel
def letters(x):
    return größe(x) + μ(x)
"""


def test_results_are_of_python() -> None:
    body = "return x, n, b, (), None, Point(x, n, b), (Pair(x, 1.0), n)"
    module = load(f"@kernel\ndef main(x, n, b):\n    {body}\n")
    found = compiled(module.main)(np.float64(0.5), np.int64(-3), np.bool_(True))
    assert found == module.main(0.5, -3, True)
    kinds = [type(each) for each in found]
    assert kinds == [float, int, bool, tuple, type(None), module.Point, tuple]
    assert isinstance(found[6][0], module.Pair)


def test_ints_wrap_at_64_bits() -> None:
    function = compiled(kernel_of("return n + m, n - m, n * m, -n, abs(n), n << 1", "n, m"))
    most, least = 2**63 - 1, -(2**63)
    assert function(most, 1) == (least, most - 1, most, -most, most, -2)
    assert function(least, 1) == (least + 1, most, least, least, least, 0)
    assert function(2**40, 2**30) == (2**40 + 2**30, 2**40 - 2**30, 0, -(2**40), 2**40, 2**41)


def test_what_is_undefined_in_python_is_ieee() -> None:
    function = compiled(kernel_of("return x / y, sqrt(x), floor(x), 1 / int(y)", "x, y"))
    inf = float("inf")
    assert function(1.0, 0.0)[::3] == (inf, inf)
    assert np.isnan(function(-1.0, 0.0)[1])
    assert struct.pack("d", function(-0.0, 1.0)[2]) == struct.pack("d", -0.0)
    assert function(-inf, 1.0)[2] == -inf


def test_fused_operations_are_the_only_difference() -> None:
    function = kernel_of("return x * x - y", "x, y")
    x = 1.0 + 2.0**-30
    y = x * x
    assert compiled(function, contract=False)(x, y) == 0.0
    assert compiled(function)(x, y) in (0.0, 2.0**-60), "rounded twice or once"


def test_fused_operations_may_reorder_nothing_and_keep_nan_and_zeros() -> None:
    inf, body = float("inf"), "return (x + y) - y, isnan(x * y), 0.0 * x, x + 0.0, x / y * y"
    function = kernel_of(body, "x, y")
    for values in ((1.0, 1e17), (inf, 0.0), (-0.0, 1.0), (0.1, 3.0), (float("nan"), 1.0)):
        with np.errstate(all="ignore"):
            expected = function(*map(np.float64, values))
        assert bits(compiled(function)(*values)) == bits(expected)


@pytest.mark.parametrize(
    ("argument", "error", "words"),
    [
        (np.float32(1.0), TypeError, "float, int and bool"),
        (1j, TypeError, "float, int and bool"),
        (2**63, OverflowError, "64 bits"),
        (-(2**63) - 1, OverflowError, "64 bits"),
        ((1.0, 2**70), OverflowError, "64 bits"),
        (np.zeros(3, np.float32), TypeError, "float32 with 1 dimensions; give one of float64"),
        (np.zeros(3, np.int32), TypeError, "int32"),
        (np.zeros(3, ">f8"), TypeError, ">f8"),
        (np.zeros(3, bool), TypeError, "bool with 1 dimensions"),
        (np.zeros(()), TypeError, "0 dimensions"),
        (np.zeros(3, [("a", "i4"), ("b", "f8")])["b"], TypeError, "float64"),
    ],
)
def test_an_argument_that_no_kernel_takes_is_refused(
    argument: Any, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        compiled(kernel_of("return 1", "x"))(argument)


def test_an_array_that_is_read_only_is_read_only() -> None:
    w = np.ones(3)
    w.flags.writeable = False
    assert compiled(kernel_of("return w[1]", "w"))(w) == 1.0
    with pytest.raises(KernelError, match="into a constant array"):
        compiled(kernel_of("w[1] = 2.0", "w"))(w)


def test_an_empty_array_is_of_the_type_of_others(made: list[str], folder: object) -> None:
    assert folder
    rows = compiled(kernel_of("return w.shape[0]", "w"))
    assert [rows(np.empty((0, 3))), rows(np.ones((2, 3)))] == [0, 2]
    assert len(made) == 1


def test_static_objects_are_part_of_the_kernel(made: list[str], folder: object) -> None:
    assert folder
    module = load(KERNELS)
    main = compiled(module.main)
    assert [main(module.double, "a", 1.0), main(module.triple, "b", 1.0)] == [3.0, 3.0]
    assert main(module.double, "a", 5.0) == 11.0
    assert len(made) == 2
    assert main(module.double, "a", 1) == 3, "an int is another type"
    assert len(made) == 3


def test_functions_that_look_alike_are_others(folder: object) -> None:
    """Closures, defaults and lambdas of one place, and zeros of both signs."""
    assert folder
    module = load(
        "def made(by, function, zero=0.0):\n    @kernel\n    def inner(x, more=by):\n"
        "        return x * by + more + function(2) + 1.0 / (zero + x)\n    return inner\n"
    )
    kernels = [module.made(2.0, lambda n: n), module.made(2.0, lambda n: n + 1),
               module.made(3.0, lambda n: n), module.made(2.0, abs, -0.0)]  # fmt: skip
    for each in kernels:
        outer = kernel_of("return inner(x)", "inner, x")
        assert compiled(outer, contract=False)(each, 4.0) == each(4.0)


def test_bound_arguments_are_read_anew() -> None:
    w = np.array([1.0, 2.0])
    call = bound(compiled(kernel_of("w[0] += x\nreturn w[0] + w[1]", "w, x")), w, 0.5)
    assert [call(), call()] == [3.5, 4.0]
    w[1] = 10.0
    assert call() == 12.5


def _generator() -> Any:
    def generator(x: float) -> Any:
        yield x

    return generator


def _coroutine() -> Any:
    async def coroutine(x: float) -> float:
        return x

    return coroutine


def _from_text() -> Any:
    space: dict[str, Any] = {}
    exec("def from_text(x):\n    return x", space)  # noqa: S102
    return space["from_text"]


@pytest.mark.parametrize("make", [_generator, _coroutine, _from_text, lambda: lambda x: x])
def test_a_function_without_such_a_source_is_refused(make: Callable[[], Any]) -> None:
    with pytest.raises(KernelError, match="has no source that returns a value; define it by a def"):
        compiled(kernel(make()))(1.0)


def test_too_deep_an_expression_is_refused() -> None:
    with pytest.raises(KernelError, match=r"in kernel 'tried': too deep an expression"):
        compiled(kernel_of(f"return {'-' * 2000}x", "x"))(1.0)


def test_a_name_in_other_letters_is_a_name() -> None:
    module = load(KERNELS)
    assert compiled(module.letters)(1.5) == 6.0
    assert compiled(module.größe)(1.5) == 3.0
