"""One explicit Runge-Kutta step in a frozen mode, its error estimate, and its dense output."""

from math import isfinite, sqrt

from model.compile.jit import inlined_kernel, kernel
from model.compile.views import reader, writer
from model.physics.motion import motion
from model.physics.notation import STATE_SIZE, State

# Ratio of the next step to this one: CAUTION times the error estimate's proposal, within bounds.
CAUTION, MOST_GROWTH, LEAST_GROWTH, LEAST_SHRINKING = 0.8, 5.0, 0.3, 0.1


@inlined_kernel
def is_too_short(h, time):
    """Return whether a step is below the resolution of time."""
    return h <= 1e-14 * max(1.0, time)


# (y): the state vector, shape (6,), as a ``State``; (q, out) writes a state, or its rates.
state_of = reader(State, "y", "y[{}]".format)
store_in = writer(State, "out", "out[{}]".format)


@inlined_kernel
def rates_of(time, q, p, mode):
    """dy/dτ as a ``State``."""
    at = motion(time, q, p, mode)
    return State(q.x_rate, q.y_rate, q.tilt_rate, at.x, at.y, at.tilt)


@kernel
def are_finite(rates):
    """Return whether no rate is infinite or not a number."""
    return isfinite(rates.x + rates.y + rates.tilt + rates.x_rate + rates.y_rate + rates.tilt_rate)


@inlined_kernel
def right_hand_side(time, y, p, mode, out):
    """Write dy/dτ into ``out``, shape (6,)."""
    store_in(rates_of(time, state_of(y), p, mode), out)


@inlined_kernel
def _combination(weights, count, k):
    """Σ_j weights[j] k[j] over the first ``count`` stages, as six numbers in registers."""
    s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        weight = weights[j]
        if weight != 0.0:
            s0 += weight * k[j, 0]
            s1 += weight * k[j, 1]
            s2 += weight * k[j, 2]
            s3 += weight * k[j, 3]
            s4 += weight * k[j, 4]
            s5 += weight * k[j, 5]
    return s0, s1, s2, s3, s4, s5


@inlined_kernel
def _stage(i, time, h, y, p, mode, method, k, trial):
    """Evaluate stage ``i`` into ``k[i]``, and its state into ``trial``."""
    s0, s1, s2, s3, s4, s5 = _combination(method.a[i], i, k)
    store_in(moved(state_of(y), h, State(s0, s1, s2, s3, s4, s5)), trial)
    right_hand_side(time + method.c[i] * h, trial, p, mode, k[i])


@kernel
def take_step(time, h, y, p, mode, method, k, y_end):
    """Fill stages 1..``method.stages`` of ``k`` from ``k[0]`` and write the step's end.

    Shapes: y, y_end (6,); k (m, 6) with ``k[0]`` = dy/dτ at ``time``. The last stage filled is
    dy/dτ at the end of the step.
    """
    for i in range(1, method.stages + 1):
        _stage(i, time, h, y, p, mode, method, k, y_end)


@inlined_kernel
def moved(q, h, rates):
    """The state ``q`` + h ``rates``."""
    return State(
        q.x + h * rates.x, q.y + h * rates.y, q.tilt + h * rates.tilt,
        q.x_rate + h * rates.x_rate, q.y_rate + h * rates.y_rate,
        q.tilt_rate + h * rates.tilt_rate,
    )  # fmt: skip


@kernel
def short_step(time, h, q, p, mode):
    """State after a short step ``h`` of the classical Runge-Kutta method of order 4."""
    k1 = rates_of(time, q, p, mode)
    k2 = rates_of(time + 0.5 * h, moved(q, 0.5 * h, k1), p, mode)
    k3 = rates_of(time + 0.5 * h, moved(q, 0.5 * h, k2), p, mode)
    k4 = rates_of(time + h, moved(q, h, k3), p, mode)
    outer, inner = moved(moved(q, h / 6.0, k1), h / 6.0, k4), h / 3.0
    return moved(moved(outer, inner, k2), inner, k3)


@inlined_kernel
def error_estimate(h, y, y_end, method, k, tolerance):
    """Return the local error over the tolerance; a step is accepted if it is <= 1.

    Root mean square over the state, each component relative to 1 + its size; see ``Tableau.error``.
    """
    fine, coarse = 0.0, 0.0
    for n in range(STATE_SIZE):
        scale = tolerance * (1.0 + max(abs(y[n]), abs(y_end[n])))
        first, second = 0.0, 0.0
        for j in range(method.stages + 1):
            first += method.error[0, j] * k[j, n]
            second += method.error[1, j] * k[j, n]
        fine += (first / scale) ** 2
        coarse += (second / scale) ** 2
    if fine == 0.0:
        return 0.0
    return abs(h) * fine / sqrt((fine + 0.01 * coarse) * STATE_SIZE)


@kernel
def dense_output(time, h, y, p, mode, method, k, trial, dense):
    """Fill the remaining stages of ``k`` and ``dense``, see ``dense_coefficients``."""
    for i in range(method.stages + 1, method.c.size):
        _stage(i, time, h, y, p, mode, method, k, trial)
    dense_coefficients(method, k, dense)


@kernel
def dense_coefficients(method, k, dense):
    """Fill ``dense``, shape (6, degree): y(θ) = y + h Σ_i dense[:, i] θ^(i+1)."""
    for i in range(dense.shape[1]):
        s0, s1, s2, s3, s4, s5 = _combination(method.dense[:, i], method.c.size, k)
        dense[0, i], dense[1, i], dense[2, i] = s0, s1, s2
        dense[3, i], dense[4, i], dense[5, i] = s3, s4, s5


@inlined_kernel
def _component(n, theta, h, y, dense):
    value = 0.0
    for i in range(dense.shape[1] - 1, -1, -1):
        value = (value + dense[n, i]) * theta
    return y[n] + h * value


@inlined_kernel
def interpolate(theta, h, y, dense):
    """``State`` at the fraction ``theta`` of the step."""
    return State(
        _component(0, theta, h, y, dense),
        _component(1, theta, h, y, dense),
        _component(2, theta, h, y, dense),
        _component(3, theta, h, y, dense),
        _component(4, theta, h, y, dense),
        _component(5, theta, h, y, dense),
    )
