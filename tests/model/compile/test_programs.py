"""Random programs of the subset give the same numbers as Python, to the bit."""

from typing import Any

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from model.compile.source import KernelError
from tests.model.compile.programs import LENGTH, Program, programs
from tests.model.compile.sources import bits, exactly, load

FLOATS = st.sampled_from([0.0, -0.0, 1.0, -1.5, 0.1, 3.0, 1e10, -(2.0**-40), 1e300, float("inf")])
INTS = st.sampled_from([0, 1, -1, 2, 3, -5, 8, 1000, 2**31, -(2**40), 2**62, -(2**63), 2**63 - 1])
POINTS = st.tuples(FLOATS, INTS, st.booleans())
ARGUMENTS = st.tuples(
    FLOATS, FLOATS, INTS, INTS, st.booleans(), POINTS,
    st.lists(FLOATS, min_size=LENGTH + 1, max_size=LENGTH + 1),
    st.lists(INTS, min_size=LENGTH, max_size=LENGTH),
)  # fmt: skip


@settings(
    max_examples=150, deadline=None, derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)  # fmt: skip
@given(program=programs(), arguments=st.lists(ARGUMENTS, min_size=8, max_size=8))
def test_a_program_computes_what_python_computes(
    program: Program, arguments: list[tuple[Any, ...]]
) -> None:
    mine, reference = load(program.kernels()), load(program.reference())
    main = exactly(mine.main)
    for *numbers, point, floats, ints in arguments:
        w, k = np.array(floats), np.array(ints)
        pythons_w = reference.Numbers(float, list(floats))
        pythons_k = reference.Numbers(int, list(ints))
        try:
            expected = reference.main(*numbers, reference.Point(*point), pythons_w, pythons_k)
        except (ZeroDivisionError, OverflowError, ValueError):
            continue  # no number in Python: 1 / 0, int of NaN
        try:
            found = main(*numbers, mine.Point(*point), w, k)
        except KernelError as error:  # known numbers that Python refuses too, if it comes by
            assume("does not fit into 64 bits" not in str(error))
            assume("division by zero" not in str(error))
            raise
        assert bits(found) == bits((float(expected[0]), expected[1])), (
            numbers,
            point,
            floats,
            ints,
        )
        assert bits(w) == bits(np.array(pythons_w.values))
        assert bits(k) == bits(np.array(pythons_k.values))
