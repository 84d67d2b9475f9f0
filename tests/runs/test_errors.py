"""Whether the estimated error of an alignment time is honest."""

import numpy as np
import pytest

from model import Batch, Outcome, align

SEEDS = [0, 1]
COUNT = 200


def cloud(device, seed):
    """Every parameter that is not zero, log-uniform within a factor of √e around the device."""
    rng = np.random.default_rng(seed)
    swept = {
        name: value * np.exp(rng.uniform(-0.5, 0.5, COUNT))
        for name, value in device.given().items()
        if value
    }
    return Batch.of(device, **swept)


@pytest.fixture(scope="module", params=SEEDS)
def pair(request, device):
    """Results at a tolerance of 1e-10, and at 1e-13 the truth."""
    batch = cloud(device, request.param)
    return align(batch, horizon=60.0), align(batch, horizon=60.0, tolerance=1e-13)


def test_the_true_error_lies_below_the_estimate(pair):
    result, truth = pair
    certain = (result.outcome == Outcome.ALIGNED) & ~result.sensitive
    assert certain.sum() > 100
    error = np.abs(result.tau_align - truth.tau_align)[certain]
    assert (error <= result.tau_error[certain]).mean() >= 0.95


def test_the_estimate_is_not_far_too_large(pair):
    result, truth = pair
    certain = (result.outcome == Outcome.ALIGNED) & ~result.sensitive
    error = np.abs(result.tau_align - truth.tau_align)[certain]
    # It is the error of a run at 16 times the tolerance, so 16 times too large in the mean.
    ratio = np.median(result.tau_error[certain] / np.maximum(error, 1e-15))
    assert 4.0 < ratio < 64.0


def test_whether_a_part_aligns_is_certain_unless_flagged(pair):
    result, truth = pair
    differs = (result.outcome == Outcome.ALIGNED) != (truth.outcome == Outcome.ALIGNED)
    assert not (differs & ~result.sensitive).any()


def test_sensitive_points_are_few_and_have_large_errors_or_two_outcomes(pair):
    result, _ = pair
    assert result.sensitive.mean() < 0.05
    flagged = result.sensitive & np.isfinite(result.tau_error)
    assert (result.tau_error[flagged] > 1e-4).all()
    assert (result.tau_error[~result.sensitive & np.isfinite(result.tau_error)] <= 1.1e-4).all()


def test_an_error_is_given_for_every_certain_alignment_and_no_other(pair):
    result, _ = pair
    aligned = result.outcome == Outcome.ALIGNED
    assert np.isfinite(result.tau_error[aligned & ~result.sensitive]).all()
    assert np.isnan(result.tau_error[~aligned]).all()
    assert (result.tau_error[np.isfinite(result.tau_error)] > 0.0).all()
