"""Runs without event location, and their right-hand side for other solvers; see ``engine``."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from model.engines.batch.workspace import new_workspace
from model.engines.scalar.tableaux import DORMAND_PRINCE, RK4
from model.physics.compiled import called_often
from model.physics.notation import STATE_SIZE
from model.physics.parameters import Batch, Parameters
from model.physics.readings import Readings
from verification.without_location.engine import (
    ANY_READINGS,
    NONE_PRINTED,
    PASSAGE_SIZE,
    ROWS,
    outside_of,
    run_with_adaptive_steps,
    run_with_fixed_steps,
    write_rates_of,
)

Floats = NDArray[np.float64]
Scheme = Literal["rk4", "semi_implicit_euler", "dormand_prince"]


@dataclass(frozen=True)
class Runs:
    """Results of a batch without event location; dimensionless, in the order of the batch.

    ``tau_align``, ``time`` (of the end), ``rhs_evaluations`` and ``finished`` have shape (n,),
    ``state`` (n, 6). ``tau_align`` is NaN where the part did not fall in; ``finished`` is False
    where the evaluations ran out before it fell in or reached the horizon.
    """

    tau_align: Floats
    time: Floats
    rhs_evaluations: NDArray[np.int64]
    finished: NDArray[np.bool_]
    state: Floats


def align(
    batch: Batch | Sequence[Parameters],
    scheme: Scheme,
    resolution: float,
    *,
    readings: Readings | None = None,
    horizon: float = 300.0,
    max_evaluations: int = 20_000_000,
) -> Runs:
    """Run every parameter set of ``batch`` without locating any event but the fall.

    Args:
        batch: a ``Batch``, or a sequence of ``Parameters``.
        scheme: "rk4" and "semi_implicit_euler" take equal steps and look for the fall at their
            ends; "dormand_prince" adapts its steps and locates the fall within one.
        resolution: length of a fixed step, or tolerance relative to 1 + |state|.
        readings: variant of the equations, the consistent one by default.
        horizon: latest time.
        max_evaluations: largest number of right-hand-side evaluations of a run.

    Raises:
        ValueError: an unknown scheme, or a resolution or a horizon that is not finite and > 0.
    """
    if scheme not in get_args(Scheme):
        valid = ", ".join(get_args(Scheme))
        raise ValueError(f"scheme = {scheme!r}: must be one of {valid}")
    for name, value in {"resolution": resolution, "horizon": horizon}.items():
        if not (value > 0.0 and math.isfinite(value)):
            raise ValueError(f"{name} = {value!r}: must be a finite number > 0")
    rows_of = batch if isinstance(batch, Batch) else Batch.stack(batch)
    rows = rows_of.constants(readings or Readings())
    out = np.empty((len(rows), PASSAGE_SIZE + STATE_SIZE))
    if scheme == "dormand_prince":
        method = DORMAND_PRINCE.method
        run_with_adaptive_steps(
            rows, float(resolution), method, float(horizon), int(max_evaluations), out,
            np.empty(STATE_SIZE), np.empty((method.stages + 1, STATE_SIZE)),
        )  # fmt: skip
    else:
        none_printed = readings in (None, Readings.consistent())
        layout = NONE_PRINTED if none_printed else ANY_READINGS
        run_with_fixed_steps(
            rows, layout, scheme == "semi_implicit_euler", float(resolution), RK4.method,
            float(horizon), int(max_evaluations), out, new_workspace(ROWS),
        )  # fmt: skip
    return Runs(
        tau_align=out[:, 0].copy(),
        time=out[:, 1].copy(),
        rhs_evaluations=out[:, 2].astype(np.int64),
        finished=out[:, 3] == 1.0,
        state=out[:, PASSAGE_SIZE:].copy(),
    )


@dataclass(frozen=True)
class InitialValueProblem:
    """One parameter set as an initial value problem for a solver of general use.

    ``rates(τ, y)`` gives dy/dτ, shape (6,), compiled; ``fall(τ, y)`` has a down-crossing as the
    part falls in; ``start`` has shape (6,).
    """

    rates: Callable[[float, Floats], Floats]
    fall: Callable[[float, Floats], float]
    start: Floats


def initial_value_problem(
    parameters: Parameters, readings: Readings | None = None
) -> InitialValueProblem:
    """Return ``parameters`` as a problem whose right-hand side does not depend on a mode."""
    row = Batch.stack([parameters]).constants(readings or Readings())[0]
    write_rates, outside = called_often(write_rates_of), called_often(outside_of)
    # A run that may evaluate nothing ends where it starts.
    start = align([parameters], "rk4", 1.0, readings=readings, max_evaluations=0).state[0]

    def rates(time: float, y: Floats) -> Floats:
        dy = np.empty(STATE_SIZE)
        write_rates(time, y, row, dy)
        return dy

    return InitialValueProblem(rates=rates, fall=lambda _, y: outside(y, row), start=start)
