"""Posterior of the unknowns: right where it is known, and against brute force; the fit."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from tests.vibralign.known.bench import FILE, QUICK, SETTINGS, TRUTH, trials_of, truth_of
from vibralign import DoubtWarning, calibrate, load_device
from vibralign.device.unknown import Range
from vibralign.known.fit import fit_of, rivals_of
from vibralign.known.likelihood import OUTLIERS, WIDEST, log_density, log_failing, log_likelihood
from vibralign.known.next_trial import information, next_of
from vibralign.known.possible import run_sets, touch_downs
from vibralign.known.posterior import Samples, equally, quantiles, sample
from vibralign.known.trials import read_trials

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
    low, high = quantiles(shares[:, 0], found.weights, (0.05, 0.95))
    np.testing.assert_allclose([low, high], 0.6 + 1.645 * size * np.array([-1, 1]), atol=0.01)
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


def test_a_rival_that_is_better_shows_that_the_model_does_not_fit():
    # The model takes the same time at every setting, a rival 1.35 times as long at every other.
    longer = np.tile([1.0, 1.35], 4)
    rows = [{"press_force": f"{force} N", "result": f"{100.0 * each} ± {20.0 * each} ms"}
            for force, each in zip(range(4, 12), longer, strict=True)]  # fmt: skip
    trials = read_trials(load_device(FILE), rows)
    z = norm.ppf((np.arange(64) + 0.5) / 64.0)[:, None]
    times = [np.exp(np.linspace(-3.5, -1.0, 64))[:, None] * np.ones(4)] * 8
    logs = sum(log_likelihood(trial, each, 2.0) for trial, each in zip(trials, times, strict=True))
    samples = Samples(z, logs, math.log(64) + norm.logpdf(z[:, 0]))
    each = zip(trials, longer, times, strict=True)
    better = sum(log_likelihood(trial, factor * own, 2.0) for trial, factor, own in each)
    assert fit_of(trials, times, samples, 2.0, {}).fits
    found = fit_of(trials, times, samples, 2.0, {"like": logs[:32], "better": better})
    assert found.rivals["like"] == pytest.approx(0.0)
    assert found.rivals["better"] > 0.5
    assert not found.fits


def test_rivals_have_another_base_approach_or_friction():
    device = load_device(FILE)
    rows = [{"press_force": f"{force} N", "result": "fails"} for force in (4, 10, 16)]
    sets = {"friction": np.array([0.2, 0.3]), "tilt_stiffness": np.array([0.3, 0.3])}

    def rivals(device, rows=rows):
        trials = read_trials(device, rows)
        return [each(trials[0].device, sets) for each in rivals_of(device, trials).values()]

    (lowered, same), (soft, _), (falling, own) = rivals(device)
    assert (lowered.sudden, lowered.vibrator) == (False, "running")
    assert same == sets
    assert soft.quantities["contact_stiffness"] == pytest.approx(1e5)
    assert falling.quantities == device.changed(press_force=4.0).quantities
    np.testing.assert_allclose(own["friction"], sets["friction"] * math.sqrt(10.0 / 4.0))
    del sets["friction"]
    known = rivals(device.changed(friction=0.2))[-1][1]
    np.testing.assert_allclose(known["friction"], 0.2 * math.sqrt(10.0 / 4.0) * np.ones(2))
    still = rivals(device.changed(approach_speed=0.02, vibrator="running"), rows[:1] * 2)
    assert [each.vibrator for each, _ in still] == ["still", "running"]
    open_base = replace(device, unknown={**device.unknown, "contact_stiffness": Range(1e5, 1e6)})
    assert len(rivals(open_base, rows[:1] * 2)) == 1


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
    assert len(misfit.fit.rivals) == 2
    with pytest.raises(ValueError, match="nothing can be concluded"):
        misfit.next()
    soft = device.changed(contact_stiffness=5e4)
    with pytest.warns(DoubtWarning, match="soft base"):
        doubted = calibrate(soft, torn[2:4], QUICK, touch_downs_tried=2, target=5.0)
    assert any("do not trust the verdict" in each for each in doubted.notes)
    for asked in (misfit.intervals, misfit.posterior):
        with pytest.raises(ValueError, match="does not fit these trials"):
            asked()


def test_a_part_that_goes_in_before_the_vibrator_sets_in_has_gone_in_at_once():
    still = load_device(FILE).changed(approach_speed=0.03, vibrator="still")
    rows = [{**setting, "result": "60 ms"} for setting in [SETTINGS[6]] * 2]
    ranges = {"friction": Range(0.32, 0.4), "tilt_stiffness": Range(0.15, 0.2)}
    still = replace(still, unknown=ranges)
    found = calibrate(still, rows, QUICK, touch_downs_tried=4, target=5.0)
    assert min(np.nanmin(each) for each in found.times) == pytest.approx(1e-4)
    assert np.isfinite(found.fit.predicted).all()


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
