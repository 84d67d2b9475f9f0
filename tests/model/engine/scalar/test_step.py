"""One step: observed orders on smooth motions, error estimate, dense output."""

import numpy as np
import pytest

from model.engine.scalar.step import error_estimate, interpolate, right_hand_side
from model.engine.scalar.tableaux import DOP853
from model.physics.modes import OPEN, SLIP_POSITIVE, START
from model.physics.notation import RIGHT_EDGE, STATE_SIZE, State
from tests.model.engine.steps import Steps

FREE = START._replace(face=OPEN)
SLIDING = START._replace(edge=RIGHT_EDGE, support_slip=SLIP_POSITIVE)
"""A frozen mode: with loads unclamped its vector field is smooth and nonlinear everywhere."""
BEGIN = np.array([0.2, 4.05, 0.05, 0.3, -0.1, 0.1])


def run(p, y, until, count, mode=SLIDING):
    """The state at ``until`` after ``count`` equal steps in one mode."""
    steps, h = Steps(p), until / count
    for i in range(count):
        y = steps.step(i * h, h, y, mode)
    return y


def error(steps, y, h, tolerance, mode=SLIDING):
    steps.step(0.0, h, y, mode)
    return error_estimate(h, y, steps.end, steps.k, tolerance)


@pytest.fixture(scope="module")
def p(device, constants):
    return constants(device.replace(frequency=3.0))


def slope(sizes, errors):
    """Exponent of errors ~ sizes^slope, by least squares in logarithms."""
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


# Steps a unit of time, so that errors lie well above rounding and in the asymptotic range. The
# suspended motion has no fast contact in it and takes steps four times as long.
COUNTS = [8, 12, 16, 24]


@pytest.mark.parametrize(
    ("mode", "until"), [(FREE, 4.0), (SLIDING, 1.0)], ids=["suspended", "sliding"]
)
def test_global_error_falls_with_the_order_of_the_step(p, mode, until):
    exact = run(p, BEGIN, until, 400, mode)
    errors = [np.abs(run(p, BEGIN, until, n, mode) - exact).max() for n in COUNTS]
    assert min(errors) > 1e-14  # else rounding would be measured
    observed = slope([until / n for n in COUNTS], errors)
    assert observed > 0.95 * DOP853.order
    # On the linear suspended motion a method may be better than its order, not on the sliding one.
    if mode is SLIDING:
        assert observed < 1.15 * DOP853.order


def test_error_estimate_falls_with_its_order(p):
    # A local error of a method of order p is O(h^(p+1)).
    sizes = np.array([0.02, 0.03, 0.04, 0.06])
    errors = [error(Steps(p), BEGIN, h, 1e-3) for h in sizes]
    assert slope(sizes, errors) == pytest.approx(DOP853.error_order + 1, rel=0.1)


@pytest.mark.parametrize("h", [0.02, 0.05])
def test_error_estimate_bounds_the_true_local_error(p, h):
    steps = Steps(p)
    estimate = error(steps, BEGIN, h, 1.0)  # over 1 + |y|, root mean square
    exact = run(p, BEGIN, h, 16)
    scaled = (steps.end - exact) / (1.0 + np.maximum(abs(BEGIN), abs(exact)))
    # The step is of higher order than the estimate: its error is smaller.
    assert np.sqrt(np.mean(scaled**2)) < estimate


def test_error_estimate_is_over_the_tolerance(p):
    steps = Steps(p)
    one, tenth = (error(steps, BEGIN, 0.05, tolerance) for tolerance in (1e-6, 1e-7))
    assert tenth == pytest.approx(10 * one, rel=1e-12)  # homogeneous of degree one


def test_error_estimate_is_zero_where_nothing_moves(device, constants):
    still = constants(device.replace(press_force=0.0, frequency=0.0))
    at_rest = np.array([still.rest_x, still.rest_y, still.rest_tilt, 0.0, 0.0, 0.0])
    steps = Steps(still)
    assert error(steps, at_rest, 0.1, 1e-10, FREE) == 0.0
    assert np.array_equal(steps.end, at_rest)


def test_last_stage_is_the_slope_at_the_end(p):
    steps, slope_at_end = Steps(p), np.empty(6)
    end = steps.step(0.2, 0.05, BEGIN, SLIDING)
    right_hand_side(0.25, end, p, SLIDING, slope_at_end)
    # The stage's time is 0.2 + 1.0 * 0.05, one rounding apart.
    assert steps.k[DOP853.stages] == pytest.approx(slope_at_end, rel=1e-12)


def test_dense_output_runs_from_the_start_to_the_end_of_the_step(p):
    steps = Steps(p)
    steps.dense_step(0.2, 0.05, BEGIN, SLIDING)
    assert interpolate(0.0, 0.05, BEGIN, steps.dense) == tuple(BEGIN)
    at_end = interpolate(1.0, 0.05, BEGIN, steps.dense)
    assert at_end == pytest.approx(steps.end, rel=1e-12)
    assert isinstance(at_end, State)
    assert len(at_end) == STATE_SIZE


def test_dense_output_falls_with_its_order(p):
    order, sizes = 7, [0.04, 0.06, 0.08]  # steps that keep its error over 1e-13
    steps, errors = Steps(p), []
    for h in sizes:
        steps.dense_step(0.0, h, BEGIN, SLIDING)
        worst = 0.0
        for theta in (0.3, 0.6, 0.8):
            exact = run(p, BEGIN, theta * h, 8)
            within = np.array(interpolate(theta, h, BEGIN, steps.dense))
            worst = max(worst, np.abs(within - exact).max())
        errors.append(worst)
    # A local quantity: one order more than the extension's.
    assert slope(sizes, errors) > 0.95 * (order + 1)
