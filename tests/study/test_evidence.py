"""Random devices, whose verdicts are stored, and cases: other assumptions and devices."""

import shutil

import numpy as np
import pytest

from model.physics import forces
from model.sweeps.axes import Axis
from study.claims import CLAIMS, checks
from study.config import Study, check_study, load_study, read_study, study_path
from study.evidence.cases import KINDS, cases_dataset, cases_plan
from study.evidence.null import (
    null_plan,
    null_text,
    stored_null,
    verdicts_of,
)
from study.identification.space import own_values, space_of


@pytest.fixture(scope="module")
def study() -> Study:
    """The study with few devices on a tiny grid."""
    stated = read_study(study_path())
    counts = {f"fig{number:02}": 6 for number in range(6, 15)} | {"fig05": 1}
    stated["evidence"] |= {
        "grid": {"counts": counts, "horizon": 5.0, "tolerance": 1e-5}, "random": 3, "near": 2,
        "assumptions": [
            {"title": "pressed", "settings": {"start": "pressed"}},
            {"title": "as here", "held": {"phase": 0.0}},
        ],
    }  # fmt: skip
    return check_study(stated)


@pytest.fixture(scope="module")
def plan(study):
    return null_plan(study)


@pytest.fixture(scope="module")
def stored(plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("null") / "null.csv"
    path.write_text(null_text(plan), encoding="utf-8")
    return path


def test_the_stored_verdicts_are_those_of_the_study() -> None:
    plan = null_plan(load_study(study_path()))
    found = stored_null(plan)
    assert found.verdicts.shape == (plan.count, len(CLAIMS))
    assert [*found.shares] == [claim.id for claim in CLAIMS]
    again = verdicts_of(plan.space, plan.devices[:4], plan.grid)
    assert (again == found.verdicts[:4]).mean() > 0.95  # rounding turns some


def test_what_was_stored_is_read_again(plan, stored) -> None:
    found = stored_null(plan, stored)
    assert (found.verdicts == verdicts_of(plan.space, plan.devices, plan.grid)).all()
    assert found.counts.tolist() == (found.verdicts == 0).sum(axis=1).tolist()
    assert found.shares["L01"] == (found.verdicts[:, 0] == 0).mean()


@pytest.mark.parametrize("change", ["priors", "list", "physics", "grid", "count"])
def test_a_key_that_no_longer_fits_is_refused_with_the_command(
    plan, stored, change, monkeypatch, tmp_path
) -> None:
    if module := {"list": checks, "physics": forces}.get(change):
        copy = tmp_path / "copy.py"
        shutil.copy(module.__file__, copy)
        monkeypatch.setattr(module, "__file__", str(copy))
        assert stored_null(plan, stored)
        with copy.open("a", encoding="utf-8") as file:
            file.write("# a comment is no change\n")
        assert stored_null(plan, stored)
        with copy.open("a", encoding="utf-8") as file:
            file.write("ANOTHER = 1\n")
        other = plan
    elif change == "priors":
        prior = plan.space.problem.structure["half_width"].model_copy(update={"low": 0.16})
        structure = {**plan.space.problem.structure, "half_width": prior}
        problem = plan.space.problem.model_copy(update={"structure": structure})
        other = plan.model_copy(
            update={"space": plan.space.model_copy(update={"problem": problem})}
        )
    elif change == "grid":
        grid = plan.grid.model_copy(update={"horizon": 6.0})
        other = plan.model_copy(update={"grid": grid})
    else:
        other = plan.model_copy(update={"count": 4})
    with pytest.raises(ValueError, match=r"null\.csv: .* make null"):
        stored_null(other, stored)


def test_another_device_or_grid_of_the_study_needs_no_other_draw(study, plan) -> None:
    fig06 = study.figures["fig06"]
    axis = Axis(parameter="press_force", start=0.25, stop=20.0, count=25)
    figures = {**study.figures, "fig06": fig06.model_copy(update={"swept": axis})}
    structure = {**study.structure, "half_width": 0.9, "inertia": 5.0}
    other = study.model_copy(update={"figures": figures, "structure": structure})
    assert null_plan(other).key == plan.key


def test_without_a_file_or_with_a_damaged_one_the_command_is_named(plan, stored, tmp_path) -> None:
    with pytest.raises(ValueError, match="make null"):
        stored_null(plan, tmp_path / "none.csv")
    damaged = tmp_path / "null.csv"
    damaged.write_text(stored.read_text(encoding="utf-8").replace("+", "!"), encoding="utf-8")
    with pytest.raises(ValueError, match="make null"):
        stored_null(plan, damaged)


def test_cases_are_the_device_itself_near_ones_assumptions_and_others(study) -> None:
    space = space_of(study)
    own = own_values(study, space)
    others = {"wide": own}
    plan = cases_plan(
        study.model_copy(update={"evidence": study.evidence.model_copy(update={"others": others})})
    )
    dataset = cases_dataset(plan, np.array([3, 5]))
    kinds = [KINDS[kind] for kind in dataset["kind"].values]
    assert kinds == ["device", "near", "near", "assumption", "assumption", "other", "other"]
    verdicts = dataset["verdict"].values
    np.testing.assert_array_equal(verdicts[4], verdicts[0])  # the phase is 0 anyway
    np.testing.assert_array_equal(verdicts[5], verdicts[0])
    np.testing.assert_array_equal(verdicts[6], verdicts[3])  # pressed first
    for case in list(plan.cases)[1:3]:
        ratios = np.array([case.device[name] / own[name] for name in own])
        off = np.abs(ratios - 1.0)
        assert (off < 0.05 + 1e-9).all()  # less where a prior ends
        assert (off > 0.05 - 1e-9).mean() > 0.8
