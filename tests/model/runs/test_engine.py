"""The engine on clouds of devices: estimates hold, and rows do not depend on each other."""

from dataclasses import fields

import numpy as np
import pytest

from model.engine.scheduling import MOST_RUNS
from model.runs.engine import engine_for
from model.runs.errors import outcomes_differ
from vibralign import Alignments, Batch, Outcome, Settings, Variants, align

SETTINGS = Settings(horizon=60.0)
COUNT = 150


def cloud(device, spread, count=COUNT):
    """Devices around ``device``, log-uniform; a wide cloud meets every kind of contact."""
    rng = np.random.default_rng(7)
    names = ("half_height", "inertia", "tilt_stiffness", "press_force", "frequency", "friction")
    swept = {
        name: getattr(device, name) * np.exp(rng.uniform(-spread, spread, count)) for name in names
    }
    swept["initial_tilt"] = rng.uniform(-0.1, 0.3, count) if spread > 1.0 else np.full(count, 0.001)
    swept["misalignment"] = rng.uniform(0.0, 1.0, count) if spread > 1.0 else np.full(count, 0.2)
    return Batch.of(device, **swept)


@pytest.fixture(scope="module", params=[0.5, 1.5], ids=["near", "wide"])
def batch(request, device):
    return cloud(device, request.param)


def on_hard_bases(device):
    """Devices around ``device`` on bases that are hard and well damped."""
    rng, made = np.random.default_rng(4), []
    per_mass = 1.0 + device.half_width**2 / device.inertia
    for _ in range(16):
        stiffness, ratio = 10.0 ** rng.uniform(6.0, 7.0), 10.0 ** rng.uniform(-0.5, 0.5)
        damping = 2.0 * ratio * np.sqrt(stiffness / per_mass)
        made.append(
            device.replace(
                contact_stiffness=stiffness, contact_damping=damping,
                press_force=rng.uniform(1.0, 5.0), frequency=10.0 ** rng.uniform(-0.3, 1.0),
                tilt_stiffness=rng.uniform(5.0, 25.0), friction=rng.uniform(0.02, 0.2),
            )
        )  # fmt: skip
    return Batch.stack(made)


def agree(batch, settings, exact, least):
    """Assert that runs end as at the tolerance ``exact``, at times within their estimates."""
    found, other = align(batch, settings), align(batch, settings, tolerance=exact)
    certain = ~(found.sensitive | other.sensitive)
    assert certain.mean() > 0.9
    # A periodic motion may be seen to settle later.
    assert not outcomes_differ(found.outcome, other.outcome, alike=True)[certain].any()
    left = certain & (found.outcome == Outcome.LEFT_SCENE)
    assert (found.reason == other.reason)[left].all()
    aligned = certain & (found.outcome == Outcome.ALIGNED)
    assert aligned.sum() > least
    allowed = (found.tau_error + other.tau_error)[aligned]
    ratio = np.abs(found.tau_align - other.tau_align)[aligned] / allowed
    assert (ratio <= 1.0).mean() >= 0.95
    assert ratio.max() <= 10.0
    assert found.tilt_max[certain] == pytest.approx(other.tilt_max[certain], rel=1e-3)
    return ratio


def test_estimates_hold_on_hard_well_damped_bases(device):
    agree(on_hard_bases(device), Settings(horizon=8.0, tolerance=1e-9), 1e-12, 4)


def test_estimates_hold_and_are_not_much_too_large(device):
    ratios = [
        agree(cloud(device, spread, 4 * COUNT), Settings(horizon=20.0), 1e-13, COUNT)
        for spread in (0.5, 1.5)
    ]
    assert 1.0 / np.median(np.concatenate(ratios)) <= 30.0


def round_parts(device, count):
    """Round parts near and beyond the largest misalignment, tilted both ways, that slide or hop."""
    rng = np.random.default_rng(12)
    names = ("half_height", "inertia", "tilt_stiffness", "press_force", "frequency", "friction")
    swept = {name: getattr(device, name) * np.exp(rng.uniform(-0.7, 0.7, count)) for name in names}
    swept["clearance"] = 10.0 ** rng.uniform(-2.0, -0.7, count)
    swept["initial_tilt"] = rng.uniform(-0.02, 0.1, count)
    farthest = device.half_width * np.sqrt(swept["clearance"] * (2.0 + swept["clearance"]))
    swept["misalignment"] = farthest * rng.uniform(0.3, 1.2, count)
    return Batch.of(device, **swept)


def test_estimates_hold_on_random_round_parts(device):
    settings = Settings(horizon=40.0, shape="round")
    agree(round_parts(device, 4 * COUNT), settings, 1e-12, COUNT)


def test_estimates_hold_for_the_printed_readings(device):
    printed = Variants(
        contact_damping_law="printed", moment_arms="printed", side_gap="printed"
    )  # fmt: skip
    agree(cloud(device, 0.5), Settings(horizon=20.0, readings=printed), 1e-12, COUNT // 4)


def test_a_run_does_not_depend_on_its_neighbours(batch):
    rows = batch.constants(Variants())
    run, tolerances = engine_for(SETTINGS), np.full(len(batch), 1e-10)
    whole = run(rows, tolerances)
    order = np.random.default_rng(1).permutation(len(rows))
    assert np.array_equal(run(rows[order], tolerances), whole[order], equal_nan=True)
    for count in (1, MOST_RUNS - 1, MOST_RUNS, MOST_RUNS + 1):
        assert np.array_equal(run(rows[:count], tolerances[:count]), whole[:count], equal_nan=True)


def test_every_array_has_a_row_for_each_set_and_its_own_kind(batch):
    result = align(batch, SETTINGS)
    assert {getattr(result, field.name).shape for field in fields(Alignments)} == {(COUNT,)}
    assert result.outcome.dtype == result.reason.dtype == np.int8
    assert result.sensitive.dtype == np.bool_
    assert result.rhs_evaluations.dtype == result.separations.dtype == np.int64
    assert result.tau_align.dtype == np.float64


def test_a_set_less_accurate_than_promised_is_run_again(device):
    p = device.replace(frequency=10.0)
    near = Batch.of(p, press_force=np.linspace(1.0, 6.0, 60))
    loose = align(near, SETTINGS)
    certain = (loose.outcome == Outcome.ALIGNED) & ~loose.sensitive
    assert (loose.tau_error[certain] <= 1e-8).mean() > 0.95
