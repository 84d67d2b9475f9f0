"""Posterior of the unknowns: right where it is known, and against brute force; the fit."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from tests.vibralign.known.bench import FILE, QUICK, SETTINGS, TRUTH, trials_of, truth_of
from vibralign import calibrate, load_device
from vibralign.device.unknown import Range
from vibralign.known.likelihood import OUTLIERS, WIDEST, log_density, log_failing, log_likelihood
from vibralign.known.next_trial import information, next_of
from vibralign.known.possible import equally, run_sets, touch_downs
from vibralign.known.posterior import sample

RANGES = {"a": Range(0.0, 1.0), "b": Range(1.0, 100.0)}


def test_a_known_posterior_is_found():
    # Normal in the shares of both ranges, of 0.6 ± 0.03 and 0.3 ± 0.03 with the correlation -0.8.
    middle, size, slope = np.array([0.6, 0.3]), 0.03, -0.8
    inverse = np.linalg.inv(size**2 * np.array([[1.0, slope], [slope, 1.0]]))

    def normal(sets):
        steps = np.stack([RANGES[n].share(sets[n]) for n in RANGES], axis=1) - middle
        return -0.5 * np.einsum("ij,jk,ik->i", steps, inverse, steps)

    found = sample(RANGES, normal, target=400.0)
    assert found.effective >= 400.0
    assert len(found.z) < 1200
    shares = norm.cdf(found.z)
    mean = found.weights @ shares
    covariance = (found.weights[:, None] * (shares - mean)).T @ (shares - mean)
    np.testing.assert_allclose(mean, middle, atol=4.0 * size / math.sqrt(400.0))
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), size, rtol=0.15)
    assert covariance[0, 1] / size**2 == pytest.approx(slope, abs=0.2)
    # The evidence is the integral over the ranges, which are of size 1: that of the normal one.
    evidence = np.exp(found.log_ratio + found.log_likelihood).sum()
    assert evidence == pytest.approx(math.tau * size**2 * 0.6, rel=0.1)
    rows = equally(found.weights, 64)
    np.testing.assert_allclose(shares[rows].mean(axis=0), mean, atol=0.01)


def test_the_likelihood_is_a_probability():
    times = np.array([[0.05, 0.06, 0.08, np.nan], [np.nan] * 4])
    np.testing.assert_allclose(np.exp(log_failing(times, 0.07)), 0.98 * np.array([0.5, 0.9]) + 0.01)
    logs = np.linspace(math.log(1e-4), math.log(10.0), 4001)
    whole = np.exp(log_density(times, logs, 0.03))[
        :, (logs > -6.0) & (logs < math.log(WIDEST) - 6.0)
    ]
    goes_in = whole.sum(axis=1) * (logs[1] - logs[0])  # with the half of the outliers that do
    expected = (1.0 - OUTLIERS) * np.array([3.5, 0.5]) / 5.0 + 0.5 * OUTLIERS
    np.testing.assert_allclose(goes_in, expected, rtol=0.02)


def test_a_trial_that_splits_the_verdicts_tells_all_of_the_doubt():
    times = np.array([[0.05] * 4] * 8 + [[np.nan] * 4] * 8)
    verdict = np.array([True] * 8 + [False] * 8)
    assert information(times, verdict) > 0.8
    assert information(times, np.tile([True, False], 8)) == pytest.approx(0.0, abs=1e-9)


def brute_force(device, found, side, downs):
    """Return means, widths and correlation of shares by a dense grid and fresh touch-downs."""
    names = list(device.unknown)
    marks = (np.arange(side) + 0.5) / side
    grid = np.stack([each.ravel() for each in np.meshgrid(marks, marks, indexing="ij")], axis=1)
    sets = {name: device.unknown[name].at(grid[:, i]) for i, name in enumerate(names)}
    logs = np.zeros(len(grid))
    for trial in found.trials:
        times = run_sets(trial.device, sets, touch_downs(trial.device, downs, seed=99), QUICK).time
        logs += log_likelihood(trial, times, found.horizon)
    weights = np.exp(logs - logs.max())
    return moments(grid, weights / weights.sum())


def moments(shares, weights):
    mean = weights @ shares
    covariance = (weights[:, None] * (shares - mean)).T @ (shares - mean)
    width = np.sqrt(np.diag(covariance))
    return mean, width, covariance[0, 1] / width.prod()


def compare(seed, side, downs, trials):
    device, rng = load_device(FILE), np.random.default_rng(seed)
    truth = truth_of(device, rng)
    rows = trials_of(device, truth, SETTINGS[:trials], rng)
    found = calibrate(device, rows, QUICK, touch_downs_tried=32)
    shares = np.stack([r.share(found.sets[n]) for n, r in device.unknown.items()], axis=1)
    own = moments(shares, found.samples.weights)
    return own, brute_force(device, found, side, downs)


def test_the_posterior_is_that_of_brute_force():
    (mean, width, _), (true_mean, true_width, _) = compare(3, 10, 64, 3)
    assert np.abs(mean - true_mean).max() < 0.08
    np.testing.assert_allclose(width, true_width, rtol=0.35)


def test_the_truth_lies_within_and_contradictions_do_not_fit():
    device, rng = load_device(FILE), np.random.default_rng(4)
    rows = trials_of(device, TRUTH, SETTINGS[:4], rng)
    found = calibrate(device, rows, QUICK, touch_downs_tried=8)
    assert found.concludes
    for name, (low, _, high) in found.intervals((0.01, 0.5, 0.99)).items():
        assert low <= TRUTH[name] <= high
    assert found.posterior(50).sizes == {"chain": 1, "draw": 50}
    # The same setting cannot take 20 ms three times and then fail three times.
    base = SETTINGS[4]
    torn = [{**base, "result": each} for each in ["20 ms"] * 3 + ["fails after 2 s"] * 3]
    misfit = calibrate(device, torn, QUICK, touch_downs_tried=8)
    assert not misfit.fit.fits
    assert len(misfit.fit.outside) >= 3
    with pytest.raises(ValueError, match="nothing can be concluded"):
        misfit.next()
    for asked in (misfit.intervals, misfit.posterior):
        with pytest.raises(ValueError, match="does not fit these trials"):
            asked()


@pytest.mark.nightly
def test_posteriors_of_ten_devices_are_those_of_brute_force():
    for seed in range(10):
        (mean, width, slope), (true_mean, true_width, true_slope) = compare(seed, 16, 512, 4)
        assert np.abs(mean - true_mean).max() < 0.08, seed
        np.testing.assert_allclose(width, true_width, rtol=0.35, err_msg=str(seed))
        assert slope == pytest.approx(true_slope, abs=0.35), seed


@pytest.mark.parametrize(("limit", "adds"), [("2 s", False), ("0.1 s", True)])
def test_a_trial_is_worth_making_only_where_knowing_adds_to_the_best_setting(tmp_path, limit, adds):
    file = tmp_path / "free.yaml"
    free = f"free:\n  press_force: 3 N to 14 N\nlimits:\n  time: {limit}\n"
    file.write_text(FILE.read_text() + free)
    device = load_device(file)
    sets = {name: each.at(np.linspace(0.1, 0.9, 8)) for name, each in device.unknown.items()}
    found = next_of(device, [], sets, QUICK)
    assert (found.share < 1.0) == adds
    assert (found.knowing_adds > 0.1) == adds
    assert found.is_worth_it == adds
    assert (found.trials[0].bits > 0.05) == adds
