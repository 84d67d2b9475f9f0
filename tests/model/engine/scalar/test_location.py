"""Events located inside one step whose dense output is written by hand.

In all tests but one the part hangs high above the base. Only the level of the event OVERTURNED, a
limit near π/2 less |φ|, can then reach zero. φ is chosen so that this level is a polynomial g < 1.5
with known roots.
"""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model.engine.scalar.location import NO_EVENT, NODE_PLACES
from model.events.kernels import MOST_SAMPLES, sample_into
from model.events.table import OVERTURNED, RIGHT_EDGE_ENTERS
from model.physics.modes import OPEN, START
from model.physics.notation import State
from tests.model.engine.steps import ALIGNMENT_EVENTS, Steps

FREE = START._replace(face=OPEN)
# The root of a polynomial with coefficients of order one is known to 1e-15 over its slope there.
ROUNDING = 1e-14


@pytest.fixture(scope="module")
def locate(device, constants):
    """(which, θ) for limit - φ = g(θ), g given as a ``numpy.poly1d``."""
    p = constants(device)
    upright = np.empty(MOST_SAMPLES)
    q = State(0.0, 100.0, 0.0, 0.0, 0.0, 0.0)
    sample_into(ALIGNMENT_EVENTS, 0.0, q, p, FREE, upright)
    limit = upright[OVERTURNED]
    assert limit == pytest.approx(0.5 * pi, abs=0.01)

    def make(g, time=0.0, h=1.0):
        coefficients = g.coeffs[::-1]
        y = np.array([0.0, 100.0, limit - coefficients[0], 0.0, 0.0, 0.0])
        steps = Steps(p)
        steps.dense[:] = 0.0
        steps.dense[2, : coefficients.size - 1] = -coefficients[1:] / h
        found = steps.first_event(time, h, y, FREE)
        rounding = 1e-15 * (1.0 + np.abs(coefficients).sum())
        assert steps.samples[:, OVERTURNED] == pytest.approx(g(NODE_PLACES), abs=rounding)
        return found

    return make


def with_roots(*roots, scale=1.0):
    """scale * Π (θ - root)."""
    return np.poly1d(roots, r=True) * scale


@pytest.mark.parametrize("root", [1e-6, 0.1, 0.25, 0.4999, 0.5, 0.7, 1.0 - 1e-9, 1.0 + 1e-9])
@pytest.mark.parametrize("other", [1.7, 3.0])
@pytest.mark.parametrize(("time", "h"), [(0.0, 1.0), (7.0, 1e-3), (7.0, 0.2)])
def test_a_single_crossing_is_found(locate, root, other, time, h):
    found = locate(with_roots(root, other, scale=0.5), time, h)
    expected = (OVERTURNED, pytest.approx(root, abs=ROUNDING)) if root < 1.0 else (-1, NO_EVENT)
    assert found == expected


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (0.2, 0.7), (0.55, 0.6), (0.3, 0.31), (0.6, 0.6 + 1e-5), (0.26, 0.49),
        (0.05, 0.1), (0.9, 0.95),
    ],
)  # fmt: skip
def test_a_double_crossing_between_two_samples_is_found(locate, first, second):
    # The slope at the root is second - first: rounding moves the root by 1e-15 over it.
    found = pytest.approx(first, abs=1e-15 / (second - first) + ROUNDING)
    assert locate(with_roots(first, second)) == (OVERTURNED, found)


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("where", [0.3, 0.5, 0.62])
def test_a_graze_is_an_event_if_it_goes_below_zero(locate, depth, where):
    graze = with_roots(where, where)
    assert locate(graze + depth) == (-1, NO_EVENT)
    # (θ - w)² = depth at θ = w - √depth, determined to 1e-15 / (2 √depth).
    found = pytest.approx(where - np.sqrt(depth), abs=1e-14 / np.sqrt(depth) + ROUNDING)
    assert locate(graze - depth) == (OVERTURNED, found)


def test_a_function_that_starts_on_its_zero_and_rises_has_no_event_there(locate):
    assert locate(with_roots(0.0, -1.0, scale=0.5)) == (-1, NO_EVENT)
    which, theta = locate(with_roots(0.0, 0.4, scale=-1.0))  # up, and down again at 0.4
    assert (which, theta) == (OVERTURNED, pytest.approx(0.4, abs=ROUNDING))
    which, theta = locate(with_roots(0.0, 0.1, scale=-1.0))  # the same within the first sample
    assert (which, theta) == (OVERTURNED, pytest.approx(0.1, abs=ROUNDING))


def test_a_function_that_starts_on_its_zero_and_falls_has_an_event_at_once(locate):
    which, theta = locate(with_roots(0.0, 2.0))
    assert (which, theta) == (OVERTURNED, 0.0)


@pytest.mark.parametrize("rate", [0.0, 0.3, 5.0, -0.2])
def test_parts_that_overlap_as_their_level_begins_to_apply_meet_at_once(device, constants, rate):
    # A1 is 0.01 behind the bottom face; at the largest rate it is out after 1/500 of the step.
    p, tilt, depth = constants(device), 0.05, 0.01
    place = (device.half_height - (device.slot_half_width - 0.3) * sin(tilt)) / cos(tilt)

    def first_where(depth):
        y = np.array([0.3, place - depth / cos(tilt), tilt, 0.0, rate, 0.0])
        steps = Steps(p)
        steps.dense[:] = 0.0
        steps.dense[1, 0] = rate
        found = steps.first_event(0.0, 1.0, y, FREE)
        assert steps.samples[0, RIGHT_EDGE_ENTERS] == pytest.approx(-depth, abs=1e-14)
        return found

    assert first_where(depth) == (RIGHT_EDGE_ENTERS, 0.0)
    if rate > 0.0:
        assert first_where(1e-9) == (-1, NO_EVENT)  # it leaves its zero, to rounding


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    roots=st.lists(st.floats(0.02, 3.0), min_size=1, max_size=4, unique=True),
    pair=st.tuples(st.floats(-2.0, 2.0), st.floats(0.5, 2.0)),
)
def test_the_first_of_well_separated_roots_is_found(locate, roots, pair):
    # Roots at least half a sampled interval apart, so that the minimum between two is sampled or
    # dips toward a sample, times a positive quadratic.
    apart = sorted(roots)
    apart = [r for i, r in enumerate(apart) if i == 0 or r - apart[i - 1] > 0.26]
    real, imaginary = pair
    g = with_roots(*apart) * np.poly1d([1.0, -2.0 * real, real**2 + imaginary**2])
    g = g * (np.sign(g(0.0)) / np.abs(g(np.linspace(0.0, 1.0, 201))).max())  # within ±1
    which, theta = locate(g)
    if apart[0] < 1.0 - 1e-9:
        assert which == OVERTURNED
        slope = abs(g.deriv()(apart[0]))
        assert theta == pytest.approx(apart[0], abs=1e-14 * (1 + np.abs(g.coeffs).sum()) / slope)
    elif apart[0] > 1.0:
        assert which == -1
