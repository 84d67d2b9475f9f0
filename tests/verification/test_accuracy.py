"""Accuracy trials: their law, tables and checks."""

import numpy as np
import pytest

from verification.accuracy import (
    FARTHEST,
    is_wrong,
    judge_errors,
    judge_settled,
    read_tables,
    run_trial,
    write_table,
)
from verification.trials import TRIALS, trial_of
from vibralign import Outcome, Reason, align


@pytest.fixture(scope="module", params=TRIALS)
def trial(request, fixed_study):
    return trial_of(fixed_study, request.param)


def test_sets_follow_the_law(trial, fixed_study):
    batch = trial.batch(np.arange(trial.sets))
    for name, law in fixed_study.accuracy.ranges.items():
        values = batch.values[name]
        drawn = values[values > 0.0]
        assert law.low <= drawn.min() <= drawn.max() <= law.high
        # Log-uniform: the logarithms' mean lies within 5 standard errors of the middle.
        place = np.log(drawn / law.low) / np.log(law.high / law.low)
        assert abs(place.mean() - 0.5) < 5 / np.sqrt(12 * drawn.size)
        spread = np.sqrt(law.zero * (1 - law.zero) / values.size)
        assert abs(np.mean(values == 0.0) - law.zero) <= 5 * spread


def test_the_two_trials_draw_different_sets(fixed_study):
    one, other = (trial_of(fixed_study, name).batch(np.arange(10)) for name in TRIALS)
    assert not np.intersect1d(one.values["press_force"], other.values["press_force"]).size


def test_a_set_does_not_depend_on_how_many_there_are(trial):
    few = trial.model_copy(update={"sets": 7})
    for name, values in few.batch(np.arange(7)).values.items():
        assert np.array_equal(trial.batch(np.arange(7)).values[name], values, equal_nan=True)


@pytest.fixture(scope="module")
def tables(fixed_study, tmp_path_factory):
    """Both trials on a few sets, through files."""
    found = {}
    for name, sets, horizon in (("error", 8, 30.0), ("settled", 12, 300.0)):
        trial = trial_of(fixed_study, name)
        settings = trial.settings.model_copy(update={"horizon": horizon})
        trial = trial.model_copy(update={"sets": sets, "settings": settings, "longer": 2.0})
        folder = tmp_path_factory.mktemp(name)
        paths = [folder / f"{chunk}.csv" for chunk in range(2)]
        for chunk, path in enumerate(paths):
            write_table(run_trial(trial, chunk, 2), path)
        found[name] = trial, read_tables(paths), paths
    return found


def test_a_chunk_is_what_align_says_of_its_sets(tables):
    trial, table, _ = tables["error"]
    batch = trial.batch(table["set"])
    assert np.array_equal(table["set"], np.arange(8))
    result = align(batch, trial.settings.settings, cores=1)
    assert np.array_equal(table["outcome"], result.outcome)
    assert np.array_equal(table["tau_align"], result.tau_align, equal_nan=True)
    assert np.array_equal(table["tau_error"], result.tau_error, equal_nan=True)


def test_truths_are_given_for_every_certain_alignment(tables):
    _, table, _ = tables["error"]
    certain = (table["outcome"] == Outcome.ALIGNED) & (table["sensitive"] == 0)
    assert certain.sum() >= 2
    assert np.array_equal(np.isfinite(table["independent_tau"]), certain)
    for tau in (table["tight_tau"], table["independent_tau"]):
        error = np.abs(table["tau_align"] - tau)[certain]
        assert (error <= 10 * table["tau_error"][certain]).all()


def test_settled_sets_are_run_on(tables):
    _, table, _ = tables["settled"]
    settled = table["outcome"] == Outcome.SETTLED
    assert settled.any()
    assert (table["later_outcome"][settled] == Outcome.HORIZON_REACHED).all()
    assert (table["later_moved"][settled] <= FARTHEST).all()
    assert np.isnan(table["later_moved"][~settled]).all()
    assert not is_wrong(table).any()


def test_a_missing_chunk_is_refused(tables):
    with pytest.raises(ValueError, match="do not hold each set once"):
        read_tables(tables["error"][2][1:])


# ----------------------------------------------------------------------------------------- checks


def made(**columns):
    """A table of 2,000 alignments at τ = 1 with ``tau_error`` 1e-9, ten times the true error."""
    size = 2000
    table = {
        "set": np.arange(size),
        "outcome": np.zeros(size, dtype=int),
        "tight_outcome": np.zeros(size, dtype=int),
        "sensitive": np.zeros(size, dtype=int),
        "tau_align": np.ones(size),
        "tau_error": np.full(size, 1e-9),
        "tight_tau": np.full(size, 1.0 + 1e-10),
        "independent_tau": np.full(size, 1.0 + 1e-10),
        "independent_ending": np.full(size, "aligned"),
        "reason": np.zeros(size, dtype=int),
        "end": np.ones(size),
        "independent_end": np.full(size, 1.0 + 1e-10),
    }
    return {**table, **columns}


def failing(table):
    return [check.what for check in judge_errors(table) if check.holds is False]


def first(count, value, other):
    """2,000 values, of which the first ``count`` differ."""
    return np.where(np.arange(2000) < count, value, other)


@pytest.mark.parametrize(
    ("columns", "what"),
    [
        ({}, ""),
        # A flag takes a set out of the count.
        ({"tight_tau": first(40, 2.0, 1.0 + 1e-10), "independent_tau": first(40, 2.0, 1.0 + 1e-10),
          "sensitive": first(40, 1, 0)}, ""),
        ({"tight_tau": first(101, 1.0 + 2e-9, 1.0)}, "error below tau_error, tolerance 1e-13"),
        ({"tight_tau": first(3, 1.0 + 2e-8, 1.0)}, "error below 10 tau_error, tolerance 1e-13"),
        ({"tight_tau": first(3, np.nan, 1.0)}, "error below 10 tau_error, tolerance 1e-13"),
        ({"independent_tau": first(101, 1.0 + 2e-9, 1.0 + 1e-10)},
         "error below tau_error, independent solution"),
        ({"tau_error": np.full(2000, 4e-9)}, "median of tau_error over error, tolerance 1e-13"),
        ({"sensitive": first(41, 1, 0)}, "sets flagged sensitive"),
        ({"outcome": first(1, Outcome.HORIZON_REACHED, Outcome.ALIGNED)},
         "sets of neither that align at one tolerance only"),
        ({"independent_ending": first(1, "failed", "aligned")}, "independent solutions unfinished"),
    ],
)  # fmt: skip
def test_a_target_that_is_missed_is_named(columns, what):
    failed = failing(made(**columns))
    assert what in failed if what else failed == []


def leaving(ending, count):
    """Half of the sets run against a wall; in truth, ``count`` of them end otherwise."""
    left = np.arange(2000) >= 1000
    return made(
        outcome=np.where(left, Outcome.LEFT_SCENE, Outcome.ALIGNED),
        tight_outcome=np.where(left, Outcome.LEFT_SCENE, Outcome.ALIGNED),
        reason=np.where(left, Reason.CORNER_ON_WALL, Reason.NONE),
        independent_ending=np.where(
            left, np.where(np.arange(2000) < 1000 + count, ending, "right wall"), "aligned"
        ),
    )


@pytest.mark.parametrize(
    ("ending", "count", "fails"),
    [("left wall", 1000, False), ("aligned", 1, False), ("aligned", 2, True), ("horizon", 2, True),
     ("other face", 2, True)],
)  # fmt: skip
def test_sets_leave_the_scene_as_in_the_independent_solution(ending, count, fails):
    missed = ["leave the scene as in the independent solution"] if fails else []
    assert failing(leaving(ending, count)) == missed


def test_what_is_chaotic_may_align_at_one_tolerance_only():
    moving = first(1, Outcome.HORIZON_REACHED, Outcome.ALIGNED)
    chaotic = made(outcome=moving, reason=first(1, Reason.CHAOTIC, Reason.NONE))
    assert failing(chaotic) == []
    found = {check.what: check.found for check in judge_errors(chaotic)}
    assert found["sets that are chaotic"] == "1"
    assert found["of those, sets that align at the tight tolerance"] == "1"


@pytest.mark.parametrize(
    ("later", "moved", "wrong"),
    [
        (Outcome.HORIZON_REACHED, 1e-6, False),
        (Outcome.HORIZON_REACHED, 2 * FARTHEST, True),
        (Outcome.HORIZON_REACHED, np.nan, True),
        (Outcome.ALIGNED, 1e-6, True),
        (Outcome.LEFT_SCENE, 1e-6, True),
        (Outcome.FAILED, np.nan, True),
    ],
)
def test_a_settled_set_that_goes_elsewhere_is_wrong(later, moved, wrong):
    table = {
        "set": np.array([0, 1]),
        "outcome": np.array([int(Outcome.SETTLED), int(Outcome.ALIGNED)]),
        "later_outcome": np.array([int(later), -1]),
        "later_moved": np.array([moved, np.nan]),
    }
    assert is_wrong(table).tolist() == [wrong, False]
    named = {check.what: check for check in judge_settled(table)}["wrongly settled"]
    assert named.holds is not wrong
    assert named.found == ("1: sets 0" if wrong else "0")
