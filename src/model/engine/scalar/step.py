"""One explicit Runge-Kutta step in a frozen mode, its error estimate, and its dense output."""

from math import sqrt

from model.compile.kernels import inlined_kernel, kernel
from model.engine.rates import STILL, moved, rates_of
from model.engine.scalar.tableaux import DOP853
from model.physics.notation import STATE_SIZE, State

# Ratio of the next step to this one: CAUTION times the error estimate's proposal, within bounds.
CAUTION, MOST_GROWTH, LEAST_GROWTH, LEAST_SHRINKING = 0.8, 5.0, 0.3, 0.1


@inlined_kernel
def state_of(y):
    """Return the state vector ``y``, shape (6,), as a ``State``."""
    return State(*(y[n] for n in range(STATE_SIZE)))


@inlined_kernel
def store_in(q, out):
    """Write a state, or its rates, into ``out``, shape (6,)."""
    for n, value in enumerate(q):
        out[n] = value


@inlined_kernel
def right_hand_side(time, y, p, mode, out):
    """Write dy/dτ into ``out``, shape (6,)."""
    store_in(rates_of(time, state_of(y), p, mode), out)


@inlined_kernel
def _combination(weights, count, k):
    """Σ_j weights[j] k[j] over the first ``count`` stages, as a ``State`` in registers."""
    total = STILL
    for j in range(count):
        if weights[j] != 0.0:
            total = moved(total, weights[j], state_of(k[j]))
    return total


@inlined_kernel
def _stage(i, time, h, y, p, mode, k, trial):
    """Evaluate stage ``i`` into ``k[i]``, and its state into ``trial``."""
    store_in(moved(state_of(y), h, _combination(DOP853.a[i], i, k)), trial)
    right_hand_side(time + DOP853.c[i] * h, trial, p, mode, k[i])


@kernel
def take_step(time, h, y, p, mode, k, y_end):
    """Fill stages 1..``DOP853.stages`` of ``k`` from ``k[0]`` and write the step's end.

    Shapes: y, y_end (6,); k (m, 6) with ``k[0]`` = dy/dτ at ``time``. The last stage filled is
    dy/dτ at the end of the step.
    """
    for i in range(1, DOP853.stages + 1):
        _stage(i, time, h, y, p, mode, k, y_end)


@inlined_kernel
def error_estimate(h, y, y_end, k, tolerance):
    """Return the local error over the tolerance; a step is accepted if it is <= 1.

    Root mean square over the state, each component relative to 1 + its size; see ``Tableau.error``.
    """
    fine, coarse = 0.0, 0.0
    for n in range(STATE_SIZE):
        scale = tolerance * (1.0 + max(abs(y[n]), abs(y_end[n])))
        first, second = 0.0, 0.0
        for j in range(DOP853.stages + 1):
            first += DOP853.error[0, j] * k[j, n]
            second += DOP853.error[1, j] * k[j, n]
        fine += (first / scale) ** 2
        coarse += (second / scale) ** 2
    if fine == 0.0:
        return 0.0
    return abs(h) * fine / sqrt((fine + 0.01 * coarse) * STATE_SIZE)


@kernel
def dense_output(time, h, y, p, mode, k, trial, dense):
    """Fill the remaining stages of ``k`` and ``dense``, see ``dense_coefficients``."""
    for i in range(DOP853.stages + 1, DOP853.c.size):
        _stage(i, time, h, y, p, mode, k, trial)
    dense_coefficients(k, dense)


@kernel
def dense_coefficients(k, dense):
    """Fill ``dense``, shape (6, degree): y(θ) = y + h Σ_i dense[:, i] θ^(i+1)."""
    for i in range(dense.shape[1]):
        for n, value in enumerate(_combination(DOP853.dense[:, i], DOP853.c.size, k)):
            dense[n, i] = value


@inlined_kernel
def _component(n, theta, h, y, dense):
    value = 0.0
    for i in range(dense.shape[1] - 1, -1, -1):
        value = (value + dense[n, i]) * theta
    return y[n] + h * value


@inlined_kernel
def interpolate(theta, h, y, dense):
    """``State`` at the fraction ``theta`` of the step."""
    return State(*(_component(n, theta, h, y, dense) for n in range(STATE_SIZE)))
