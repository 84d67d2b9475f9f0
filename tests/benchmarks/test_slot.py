"""The comparison in the slot with other solutions: its checks of agreement.

MuJoCo is not in this environment; `make truth` runs it.
"""

from types import SimpleNamespace

import numpy as np

from benchmarks.slot import ends_as, judge, scene_of
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


def test_the_scene_has_edges_and_corners_as_balls(device):
    assert scene_of(device).count('type="sphere"') == 4
