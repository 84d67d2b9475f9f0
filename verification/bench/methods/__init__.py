"""The compared methods, with one interface for the report's sections and for ``make bench``.

To add a method, write a subclass of ``base.Method``, and name it in ``METHODS`` for the report, or
in ``peers`` for ``make bench``.
"""

from collections.abc import Mapping

from verification.bench.methods.base import Method
from verification.bench.methods.by_hand import FixedSteps
from verification.bench.methods.package import Package

_TOGETHER = 16  # runs that spread the cost of a call, where they are short

METHODS: Mapping[str, Method] = {
    "taylor_located": Package("Taylor series, events located", batch=_TOGETHER),
    "rk4_fixed": FixedSteps("RK4, fixed steps", "rk4"),
    "semi_implicit_euler_fixed": FixedSteps(
        "semi-implicit Euler, fixed steps", "semi_implicit_euler"
    ),
}
