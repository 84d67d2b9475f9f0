"""Vector code: loops over lanes, and functions of vectors that are written as text."""

from typing import Any

import numpy as np
import pytest

from model.compile import code, machine_code, translate
from model.compile.entries import address_of, compiled, flattened
from model.compile.module import Module
from model.compile.vector_code import (
    WIDTH,
    WIDTHS,
    VectorFunction,
    VectorWriter,
    call_at,
    each_lane,
)
from model.engine.workspace import new_workspace
from tests.model.compile.sources import bits, exactly, kernel_of, load

LANES = """\
for i in each_lane():
    x = w[i]
    y = x * x + 1.0 if x > 0.5 else abs(x)
    w[WIDTH + i] = min(y, w[2 * WIDTH + i]) / 3.0
"""


def optimised(function: Any, *arguments: Any) -> str:
    types = tuple(flattened(each, []) for each in arguments)
    text = Module((function, types), None).text()
    return str(machine_code.optimised(text, machine_code._machine(), is_finished=False))


def test_a_loop_over_lanes_becomes_vector_code() -> None:
    vectors = optimised(kernel_of(LANES, "w"), np.zeros(3 * WIDTH))
    assert f"store <{WIDTH} x double>" in vectors
    assert "store double" not in vectors
    plain = optimised(
        kernel_of(LANES.replace("each_lane()", "range(WIDTH)"), "w"), np.zeros(3 * WIDTH)
    )
    assert f"store <{WIDTH} x double>" not in plain, "the loop may read what another round writes"


@pytest.mark.parametrize("width", WIDTHS)
def test_llvm_writes_nothing_to_standard_error(
    width: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    for each in (code, translate):
        monkeypatch.setattr(each, "WIDTH", width)
    optimised(kernel_of(LANES, "w"), np.zeros(3 * WIDTH))
    assert capfd.readouterr().err == ""


def test_lanes_that_the_promise_makes_free_and_their_values() -> None:
    w = np.linspace(-1.0, 2.0, 3 * WIDTH)
    mine, pythons = w.copy(), w.copy()
    function = kernel_of(LANES, "w")
    exactly(function)(mine)
    function(pythons)
    assert bits(mine) == bits(pythons)


def test_loops_over_lanes_in_kernels_that_are_called() -> None:
    module = load(
        "@inlined_kernel\ndef filled(w, line, x):\n    for i in each_lane():\n"
        "        w[line * WIDTH + i] = x + i\n\n\n"
        "@kernel\ndef main(w):\n    for i in each_lane():\n        for n in range(2):\n"
        "            w[i] += n + 1.5\n    filled(w, 1, 2.0)\n    filled(w, 2, 0.5)\n"
    )
    mine, pythons = np.ones(3 * WIDTH), np.ones(3 * WIDTH)
    exactly(module.main)(mine)
    module.main(pythons)
    assert bits(mine) == bits(pythons)


class _Polynomials(VectorWriter):
    """Writes (coefficients, places, out): sums of four orders, and of those with |place|."""

    def __init__(self, name: str) -> None:
        super().__init__(name, 3)
        coefficients, places, out = self.arguments
        x = self.load(places, 0)

        def order(index: str, total: str) -> list[str]:
            return [self.fma(total, x, self.load(self.base(coefficients, index), 0))]

        (total,) = self.repeat("4", order, self.vector(0.0))
        self.store(self.do("fadd", total, self.call("fabs", self.load(places, 0))), out, 1)
        self.store(self.do("fmul", total, self.everywhere(self.whole_number(out))), out, 0)


def test_functions_of_vectors_are_called_by_name_and_by_address() -> None:
    function = VectorFunction("polynomials", _Polynomials)
    by_name = kernel_of("FUNCTION(w, (0, 4, 5))", "w")
    by_name.__globals__["FUNCTION"] = function
    by_address = kernel_of("call_at(address, w, (0, 4, n))", "address, w, n")
    by_address.__globals__["call_at"] = call_at
    blocks = np.linspace(-1.0, 1.0, 7 * WIDTH).reshape(7, WIDTH)
    blocks[5] = 3.0
    c, x = blocks[:4], blocks[4]
    total = ((c[0] * x + c[1]) * x + c[2]) * x + c[3]
    expected = np.array([3.0 * total, total + abs(x)])
    address = address_of(function)
    for call in (compiled(by_name), lambda w: compiled(by_address)(address, w, 5)):
        w = new_workspace(7)
        w[:] = blocks
        call(w)
        assert w[5:] == pytest.approx(expected, rel=1e-15)
        assert w[:5].tolist() == blocks[:5].tolist()


class _Twice(VectorWriter):
    """Writes (block): doubles a vector, and doubles it again."""

    def __init__(self, name: str) -> None:
        super().__init__(name, 1)
        for _ in range(2):
            x = self.load(self.arguments[0], 0)
            self.store(self.do("fadd", x, x), self.arguments[0], 0)


def test_a_vector_that_was_stored_is_loaded_anew() -> None:
    function = kernel_of("FUNCTION(w, (0,))", "w")
    function.__globals__["FUNCTION"] = VectorFunction("twice", _Twice)
    w = new_workspace(1)
    w[:] = 1.0
    compiled(function)(w)
    assert w.tolist() == [[4.0] * WIDTH]


def test_another_function_of_the_same_name_is_another() -> None:
    class Other(_Polynomials):
        def vector(self, number: float) -> str:
            return super().vector(number + 1.0)

    one, other = VectorFunction("polynomials", _Polynomials), VectorFunction("polynomials", Other)
    assert one.name != other.name
    assert each_lane() == range(WIDTH)


def test_python_calls_a_function_of_vectors() -> None:
    w = new_workspace(1)
    w[:] = 1.0
    VectorFunction("twice", _Twice)(w, (0,))
    assert w.tolist() == [[4.0] * WIDTH]
