"""Implicit steps on stiff bases: the table, what they may step over, and whole runs."""

from dataclasses import fields

import numpy as np
import pytest

from model import Alignments, Batch, Outcome, Readings, Settings, align
from model.engines.scalar.tableaux import DORMAND_PRINCE
from model.engines.stiff import RADAU, _clear_until, _factor, _solve, are_stiff, radau
from model.events.table import (
    COMBINED_COUNT,
    NEVER,
    OVERTURNED,
    SAMPLE_SIZE,
    SUPPORT_SLIP,
    SWITCH_COUNT,
)

# -------------------------------------------------------------------------------------- the table


@pytest.mark.parametrize("stages", [1, 3, 5, 7])
def test_radau_integrates_what_its_order_promises(stages):
    table = radau(stages)
    nodes = table.places[1:]
    assert table.places[0] == 0.0
    assert table.places[-1] == 1.0
    # B(2s - 1): the last row integrates up to degree 2s - 2, and no further.
    for degree in range(2 * stages):
        exact = table.once[-1] @ nodes**degree == pytest.approx(1.0 / (degree + 1), rel=1e-12)
        assert bool(exact) is (degree < 2 * stages - 1)
    # C(s): every row does up to degree s - 1, once and twice over.
    for degree in range(stages):
        ways = nodes ** (degree + 1) / (degree + 1)
        assert table.once @ nodes**degree == pytest.approx(ways, abs=1e-14)
        assert table.twice @ nodes**degree == pytest.approx(
            table.once @ ways, abs=1e-14
        )  # and no more is needed of what is integrated again


def test_radau_of_three_stages_is_the_published_one():
    # Hairer and Wanner, table IV.5.6, and γ0 of (IV.8.15), for which 1/γ0 = 3.6378...
    root = np.sqrt(6.0)
    table = radau(3)
    assert table.places == pytest.approx([0.0, (4 - root) / 10, (4 + root) / 10, 1.0])
    assert table.once[0, 0] == pytest.approx((88 - 7 * root) / 360)
    assert table.once[2] == pytest.approx([(16 - root) / 36, (16 + root) / 36, 1 / 9])
    assert 1.0 / table.error[0] == pytest.approx(3.637834252744496)


def test_the_error_estimate_sees_what_the_collocation_polynomial_does_not():
    for degree in range(10):
        seen = RADAU.error @ RADAU.places**degree  # 0 ** 0 is 1
        assert bool(abs(seen) < 1e-13) is (degree < 7)


def test_linear_equations_are_solved():
    rng = np.random.default_rng(1)
    matrix, x = rng.normal(size=(21, 21)), rng.normal(size=21)
    matrix[0, 0] = 0.0  # needs a pivot
    right, pivots = matrix @ x, np.zeros(21, dtype=np.int64)
    factors = matrix.copy()
    assert _factor(factors, pivots)
    _solve(factors, pivots, right)
    assert right == pytest.approx(x, rel=1e-11)
    assert not _factor(np.zeros((2, 2)), np.zeros(2, dtype=np.int64))


# -------------------------------------------------------------------------- what it may step over


def sampled(which, function, place=lambda t: 0.0 * t):
    """Samples of a step in which only ``which`` applies."""
    samples = np.full((len(RADAU.places), SAMPLE_SIZE), NEVER)
    samples[:, which] = function(RADAU.places)
    if which < COMBINED_COUNT:
        samples[:, SWITCH_COUNT + which] = place(RADAU.places)
    return samples


@pytest.mark.parametrize(
    ("function", "until"),
    [
        (lambda t: 1.0 + 0.0 * t, 1.0),
        (lambda t: 0.3 - t, 0.3),  # falls through zero
        (lambda t: 1.0 - t, 1.0),  # at the very end: on zero there
        (lambda t: (t - 0.5) ** 2 + 0.2, 1.0),  # turns well above zero
    ],
)
def test_a_step_is_clear_until_a_function_falls(function, until):
    assert _clear_until(RADAU.places, sampled(OVERTURNED, function)) == pytest.approx(until)


def test_a_dip_between_samples_is_not_stepped_over():
    middle = 0.5 * (RADAU.places[3] + RADAU.places[4])
    dip = sampled(SUPPORT_SLIP, lambda t: 40.0 * (t - middle) ** 2 - 1e-3)
    assert (dip[:, SUPPORT_SLIP] > 0.0).all()
    assert _clear_until(RADAU.places, dip) <= RADAU.places[3]


def test_a_combined_function_that_changes_its_leader_near_zero_is_not_stepped_over():
    middle = 0.5 * (RADAU.places[3] + RADAU.places[4])

    def samples(least):  # of max(t0 - t, t - t0) + least, whose leader changes at t0
        return sampled(0, lambda t: abs(t - middle) + least, lambda t: (t > middle) * 1.0)

    assert _clear_until(RADAU.places, samples(-0.01)) <= RADAU.places[3]
    assert _clear_until(RADAU.places, samples(1.0)) == 1.0


# ------------------------------------------------------------------------------------- whole runs


def on_base(device, stiffness, ratio, **changes):
    """The device on a base with a share of the critical damping."""
    per_mass = 1.0 + device.half_width**2 / device.inertia
    damping = 2.0 * ratio * np.sqrt(stiffness / per_mass)
    return device.replace(contact_stiffness=stiffness, contact_damping=damping, **changes)


def test_what_is_stiff(device):
    def stiff(*sets):
        return are_stiff(Batch.stack(sets).constants(Readings())).tolist()

    assert stiff(device, on_base(device, 1e8, 0.0), on_base(device, 1e8, 1.0)) == [
        False, False, True,
    ]  # fmt: skip
    # The study's own hardest base, at the damping ratio of its device: explicit steps are limited
    # by the contact's ringing, which has to be resolved.
    assert stiff(device.replace(contact_stiffness=1e6, contact_damping=100.0)) == [False]
    # Damping alone makes for a fast motion; so does a hard tilt spring.
    assert stiff(device.replace(contact_damping=1e4)) == [True]
    assert stiff(device.replace(inertia=1e-3, tilt_stiffness=1e4, tilt_damping=0.4)) == [True]


@pytest.fixture(scope="module")
def hard_bases(device):
    """Sets around the device on bases that are hard and well damped."""
    rng = np.random.default_rng(4)
    return Batch.stack(
        [
            on_base(
                device, 10.0 ** rng.uniform(6.0, 7.0), 10.0 ** rng.uniform(-0.5, 0.5),
                press_force=rng.uniform(1.0, 5.0), frequency=10.0 ** rng.uniform(-0.3, 1.0),
                tilt_stiffness=rng.uniform(5.0, 25.0), friction=rng.uniform(0.02, 0.2),
            )
            for _ in range(16)
        ]
    )  # fmt: skip


def test_implicit_and_explicit_runs_agree_to_their_error_estimates(hard_bases):
    settings = Settings(horizon=8.0, tolerance=1e-9)
    stiff = align(hard_bases, settings)
    explicit = align(hard_bases, settings, engine="lanes")
    certain = ~(stiff.sensitive | explicit.sensitive)
    assert certain.mean() > 0.9
    for name in ("outcome", "reason", "separations"):
        found = getattr(stiff, name) == getattr(explicit, name)
        assert found[certain].all(), name
    aligned = certain & (stiff.outcome == Outcome.ALIGNED)
    assert aligned.sum() > 4
    apart = np.abs(stiff.tau_align - explicit.tau_align)[aligned]
    assert (apart <= (stiff.tau_error + explicit.tau_error)[aligned]).all()
    # What the steps are for, against series, which need half the evaluations of explicit steps.
    assert stiff.rhs_evaluations.sum() < 0.2 * explicit.rhs_evaluations.sum()
    # What is drawn of a run, from the places of far longer steps.
    assert stiff.tilt_max[certain] == pytest.approx(explicit.tilt_max[certain], rel=1e-3)
    # A friction limit met tangentially is met to the square root of the tolerance.
    share = np.abs(stiff.sticking_share - explicit.sticking_share)[certain]
    assert share.max() < 3e-5


def test_other_sets_are_run_as_ever(device, hard_bases):
    mild = [device.replace(press_force=force) for force in (1.0, 2.0, 3.0)]
    together = align([*mild, hard_bases[0]], horizon=10.0)
    alone = align(mild, horizon=10.0, engine="lanes")
    stiff = align([hard_bases[0]], horizon=10.0, engine="stiff")
    for field in fields(Alignments):
        found = getattr(together, field.name)
        assert np.array_equal(found[:3], getattr(alone, field.name), equal_nan=True)
        assert np.array_equal(found[3:], getattr(stiff, field.name), equal_nan=True)


def test_the_stiff_engine_is_refused_where_it_does_not_fit(device):
    with pytest.raises(ValueError, match="engine = 'stiff': needs the consistent readings"):
        align([device], engine="stiff", readings=Readings.printed())
    p = on_base(device, 1e4, 1.0)
    explicit = align([p], engine="scalar", method=DORMAND_PRINCE, horizon=1.0)
    chosen = align([p], method=DORMAND_PRINCE, horizon=1.0)
    assert chosen.rhs_evaluations == explicit.rhs_evaluations  # the method asked for is kept
