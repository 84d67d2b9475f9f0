"""Passes of a kernel against numba's own."""

import re

import numba
import pytest
from numba.core.compiler import Compiler

from model.compile.passes import KernelCompiler
from model.physics.trigonometry import sine_cosine


def branched(pair, count, factor):
    if count == 0:
        return None
    total = 0.0
    for i in range(count):
        first, second = pair
        if i % len(pair) == 0:
            sine, total = sine_cosine(first + total)
        else:
            total -= second * sine
    return total * pair[0] if factor is None else total * factor


def of_a_list(values):
    return sum([0.5 * each for each in values])


def of_a_function(x):
    def halved(y):
        return 0.5 * y

    return halved(x) + halved(1.0)


def code(compiler):
    """Return the LLVM code of ``branched``, without numba's count of functions in the names."""
    made = numba.njit(branched, pipeline_class=compiler)
    made((8.0, 2.0), 3, None)
    (text,) = made.inspect_llvm().values()
    return re.sub(r"(branchedB)\d+v\d+", r"\1", text)


def test_code_is_that_of_numbas_own_passes():
    assert code(KernelCompiler) == code(Compiler)


@pytest.mark.parametrize(
    ("function", "argument", "result"), [(of_a_list, (2.0, 4.0), 3.0), (of_a_function, 3.0, 2.0)]
)
def test_what_needs_another_pass_compiles_too(function, argument, result):
    assert numba.njit(function, pipeline_class=KernelCompiler)(argument) == result
