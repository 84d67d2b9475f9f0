import numpy as np
import pytest

from model.runs.errors import FINER
from model.runs.simulate import simulate_once
from study.config import load_study, study_path
from verification.bench.methods.base import typical_error
from verification.bench.methods.package import OneRun, Package
from verification.bench.problems import Problem, last_state, neighbours
from verification.bench.trajectories import W1, W2, W3, drawn_points, only_right_edge
from verification.independent import solve
from vibralign import Batch, Outcome, Parameters, Scene, Settings, align, simulate

EDGE_ONLY = Scene("edge_only", frozenset({"edge_on_face"}))


def test_w1_aligns_where_the_design_says() -> None:
    run = simulate(W1)
    # 1.398687866665 was measured with friction regularized by a tanh; true sticking holds longer
    assert run.tau_align == pytest.approx(1.40037, abs=5e-6)


@pytest.mark.parametrize(("case", "until"), [(W1, 2.0), (W2, 1.0), (W3, 2.0)])
def test_the_truth_is_that_of_the_independent_solution(case: Parameters, until: float) -> None:
    settings = Settings(horizon=until, may_settle=False)
    stops = () if case == W1 else (until,)
    truth = Problem("p", (case,), settings, stops).truth[0]
    solution = solve(case, until)
    assert truth == pytest.approx(solution.state if stops else [solution.tau], abs=1e-12)


def test_w2_and_w3_switch_and_do_not_align_within_their_horizon() -> None:
    sticking, bouncing = (simulate(case, horizon=100.0, may_settle=False) for case in (W2, W3))
    assert sticking.outcome == bouncing.outcome == Outcome.HORIZON_REACHED
    assert sticking.events > 300
    assert sticking.separations == 0
    assert bouncing.separations > 100


@pytest.mark.parametrize("case", [W1, W2, W3], ids=["W1", "W2", "W3"])
def test_the_trajectories_need_no_contact_but_the_edge_under_the_face(
    case: Parameters,
) -> None:
    full = simulate(case, horizon=100.0, may_settle=False)
    edge = simulate(case, horizon=100.0, may_settle=False, scene=EDGE_ONLY)
    assert full.outcome == edge.outcome
    until = full.time <= np.nan_to_num(full.tau_align, nan=100.0)
    assert np.array_equal(full.state[until], edge.state[edge.time <= full.time[until][-1]])


def test_points_of_a_figure_are_the_same_every_time_and_qualify() -> None:
    points = drawn_points("fig13", 4)
    assert points == drawn_points("fig13", 4)
    study = load_study(study_path())
    horizon = study.settings.horizon
    runs = align(points, horizon=horizon, scene=EDGE_ONLY)
    assert set(runs.outcome) == {Outcome.ALIGNED}
    assert not runs.sensitive.any()
    assert all(only_right_edge(point, horizon) for point in points)
    assert {point.frequency for point in points} == {study.parameters("fig13").frequency}


def test_the_last_state_is_the_last_of_the_trajectory() -> None:
    settings = Settings(horizon=5.0)
    whole = simulate_once(W2, settings)
    (row,) = settings.rows(Batch.stack([W2]))
    _, state = last_state(settings, row, settings.tolerance)
    # To rounding: a track takes its last row from the series of the last step once more.
    np.testing.assert_array_max_ulp(state, whole.state[-1], maxulp=4)


def test_one_run_is_judged_at_the_tolerance_at_which_it_is_timed() -> None:
    problem = Problem("W2", (W2,), Settings(horizon=2.0, may_settle=False), (1.0, 2.0))
    with_estimate = Package("").answer(problem, 1e-6).states
    assert np.array_equal(OneRun("").answer(problem, 1e-6 / FINER).states, with_estimate)
    assert not np.array_equal(OneRun("").answer(problem, 1e-6).states, with_estimate)


def test_neighbours_begin_with_the_cases_themselves_and_differ() -> None:
    batch = neighbours([W1, W2], 3)
    assert batch[:2] == (W1, W2)
    assert len(set(batch)) == 6
    assert all(abs(case.press_force / W1.press_force - 1.0) <= 1e-3 for case in batch)


def test_a_batch_has_as_many_neighbours_of_each_case() -> None:
    assert len(Problem("p", (W1, W2, W3), Settings(horizon=1.0)).batch(256)) == 258


def test_a_case_stands_in_for_neighbours_that_ask_for_other_work() -> None:
    batch = Problem("p", (W1, W2), Settings(horizon=10.0)).batch(6)
    assert len(set(batch[::2])) == 3
    assert batch[1::2] == (W2, W2, W2)  # which does not align


def test_the_typical_error_is_kept_by_nine_of_ten() -> None:
    truth = np.zeros((10, 2))
    answers = np.zeros((10, 2))
    answers[3, 1], answers[7, 0] = -0.5, 0.25
    assert typical_error(answers, truth) == 0.25
    answers[7, 0] = np.nan  # no answer
    assert typical_error(answers, truth) == 0.5
    answers[5, 0] = np.nan
    assert typical_error(answers, truth) == np.inf
