"""The comparison in the slot with other solutions: what it says of agreement.

MuJoCo is not in this environment; `make truth` runs it.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.slot import Cost, ends_as, judge, scene_of, speed_of
from model import Outcome, Reason


def run_of(outcome, reason=Reason.NONE, after=np.nan):
    return SimpleNamespace(
        outcome=outcome, reason=reason, tau_align=1.0, tau_inserted=after, insertion_error=1e-9
    )


RUNS = [
    run_of(Outcome.INSERTED, after=2.0),
    run_of(Outcome.INSERTED, after=4.0),
    run_of(Outcome.JAMMED, Reason.WEDGED),
]


def failing(checks):
    return [check.what for check in checks if check.holds is False]


def test_endings_are_those_of_the_independent_solution():
    assert ends_as(RUNS[0], "inserted")
    assert ends_as(RUNS[2], "wedged")
    assert not ends_as(RUNS[2], "lack of force")
    assert ends_as(run_of(Outcome.CLIMBED_OUT, Reason.ON_EDGE), "climbed out")
    assert ends_as(run_of(Outcome.CLIMBED_OUT, Reason.BOTH_SIDES), "both sides")
    assert not ends_as(run_of(Outcome.CLIMBED_OUT, Reason.BOTH_SIDES), "overturned")


def test_every_disagreement_fails():
    close = [(3.0 + 1e-10, True), (5.0 - 1e-10, True), (np.nan, True)]
    mujoco = np.array([2.02, 4.1, np.nan])
    assert failing(judge(RUNS, close, mujoco)) == []
    other = [*close[:2], (np.nan, False)]
    assert failing(judge(RUNS, other, mujoco)) == ["other ends, independent solution"]
    far = [(3.0 + 2e-8, True), *close[1:]]
    assert "error below 10 tau_error, independent solution" in failing(judge(RUNS, far, mujoco))
    assert failing(judge(RUNS, close, 1.2 * mujoco)) == ["MuJoCo off: median"]
    not_in = np.array([2.0, np.nan, np.nan])
    assert failing(judge(RUNS, close, not_in)) == ["MuJoCo goes in or not alike"]
    out = [RUNS[0], run_of(Outcome.CLIMBED_OUT, Reason.ON_EDGE), RUNS[2]]
    assert failing(judge(out, close, np.array([2.0, 3.0, np.nan]))) == []


def test_steps_after_alignment_are_timed():
    cost, who = speed_of("fig11", 8)
    assert who == "8 align, 0 % handed over"
    assert (cost.times > 0.0).all()
    # The same steps up to alignment, but the last, and nearly as many after it.
    assert cost.steps[1] == pytest.approx(cost.steps[0], rel=0.01)
    assert 1.5 * cost.steps[1] < cost.steps[2]
    assert cost.events[1] < cost.events[2]


def test_costs_are_of_steps_before_alignment_and_after_it():
    cost = Cost(np.array([1.0, 1.1, 2.1]), np.array([1e6, 1e6, 1.5e6]), np.array([2e5, 2e5, 3e5]))
    assert str(cost) == (
        "1.00 us a step, in the insertion scene 1.10 times as much before alignment and 2.00 times "
        "after it, with 0.20 and 0.20 events a step; whole runs 2.10 times, of 1.50 times the steps"
    )


def test_the_scene_has_edges_and_corners_as_balls(device):
    assert scene_of(device).count('type="sphere"') == 4
