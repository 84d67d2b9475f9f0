"""Fixed steps: wrong points are counted, and computed at points of the located dataset."""

import numpy as np
import pytest
import xarray as xr

from benchmarks.fixed_steps import FIXED_SCHEMES, Wrong, fixed_step_dataset, judged, wrong_counts
from benchmarks.methods.by_hand import solve_by_hand
from benchmarks.plans import FixedStepPlan
from model import Batch, Settings
from model.study.config import Study
from model.study.io import DatasetError, described, read_dataset, write_dataset
from model.study.sweep import merge, run, sweep_of

NAN = np.nan


def test_a_point_is_wrong_by_its_outcome_or_its_time() -> None:
    located = np.array([1.0, 1.0, 1.0, 1.0, NAN, NAN])
    found = np.array([1.0, 1.0999, 1.1001, NAN, 1.0, NAN])
    expected = [Wrong.NOT_WRONG, Wrong.NOT_WRONG, Wrong.WRONG_TIME]
    expected += [Wrong.WRONG_OUTCOME, Wrong.WRONG_OUTCOME, Wrong.NOT_WRONG]
    assert judged(found, located, 0.1).tolist() == expected
    both = np.array([found, found - 0.5])
    assert judged(both, located, 0.1)[1].tolist() == [2, 2, 2, 1, 1, 0]


def made_up(wrong: np.ndarray, sensitive: np.ndarray) -> xr.Dataset:
    return xr.Dataset(
        {
            "wrong": (("scheme", "step", "y", "x"), wrong.astype(np.int8)),
            "sensitive": (("y", "x"), sensitive.astype(np.int8)),
        },
        {
            "scheme": ("scheme", [0, 1], {"flag_meanings": "rk4 semi_implicit_euler"}),
            "step": ("step", [0.01, 0.001]),
        },
    )


def test_wrong_points_are_counted_by_scheme_and_step() -> None:
    wrong = np.zeros((2, 2, 2, 3))
    wrong[0, 0] = [[1, 2, 2], [0, 0, 1]]
    wrong[1, 1] = [[0, 0, 0], [2, 0, 0]]
    sensitive = np.array([[1, 1, 0], [0, 1, 0]])
    counts = wrong_counts(made_up(wrong, sensitive))
    assert counts == {
        ("rk4", 0.01): {"points": 6, "wrong_outcome": 2, "wrong_time": 2, "sensitive": 2},
        ("rk4", 0.001): {"points": 6, "wrong_outcome": 0, "wrong_time": 0, "sensitive": 0},
        ("semi_implicit_euler", 0.01): {
            "points": 6, "wrong_outcome": 0, "wrong_time": 0, "sensitive": 0,
        },
        ("semi_implicit_euler", 0.001): {
            "points": 6, "wrong_outcome": 0, "wrong_time": 1, "sensitive": 0,
        },
    }  # fmt: skip


@pytest.fixture(scope="module")
def plan(fixed_study: Study) -> FixedStepPlan:
    spec = fixed_study.figures["fig13"]
    axes = {key: getattr(spec, key).model_copy(update={"count": 7}) for key in ("x", "y")}
    figures = {**fixed_study.figures, "fig13": spec.model_copy(update=axes)}
    sweep = sweep_of(fixed_study.model_copy(update={"figures": figures}), "fig13")
    return FixedStepPlan(sweep=sweep, every=3, steps=[0.02, 0.01], tau_tolerance=0.1)


@pytest.fixture(scope="module")
def located(plan: FixedStepPlan) -> xr.Dataset:
    return merge(plan.sweep, "title", [run(plan.sweep, 0, 1)])


def test_a_figure_anew_stands_beside_the_located_one(
    plan: FixedStepPlan, located: xr.Dataset, tmp_path_factory: pytest.TempPathFactory
) -> None:
    dataset = fixed_step_dataset(plan, located)
    assert dataset.sizes == {"scheme": 2, "step": 2, "press_force": 3, "tilt_stiffness": 3}
    np.testing.assert_array_equal(
        dataset["tau_located"].values, located["tau_align"].values[::3, ::3]
    )
    aligned = ~np.isnan(dataset["tau_located"].values)
    assert 0 < aligned.sum() < aligned.size, "both kinds of points are tested"
    device = plan.sweep.baseline
    for row, scheme in enumerate(FIXED_SCHEMES):
        for column, step in enumerate(plan.steps):
            for place in np.ndindex(3, 3):
                changes = {
                    name: float(dataset[name].values[place[i]])
                    for i, name in enumerate(("press_force", "tilt_stiffness"))
                }
                settings = Settings(horizon=plan.sweep.settings.horizon)
                alone = Batch.stack([device.replace(**changes)])
                run = solve_by_hand(alone, scheme, step, settings)
                found = dataset["tau_align"].values[(row, column, *place)]
                np.testing.assert_array_equal(found, run.tau_align[0])
    path = tmp_path_factory.mktemp("data") / "fig13.nc"
    write_dataset(dataset, path)
    xr.testing.assert_identical(read_dataset(path), described(dataset))


def test_a_dataset_of_another_sweep_is_refused(plan: FixedStepPlan, located: xr.Dataset) -> None:
    foreign = located.assign_attrs(config_hash="0123")
    with pytest.raises(DatasetError, match="fig13: the dataset belongs to sweep '0123'"):
        fixed_step_dataset(plan, foreign)
