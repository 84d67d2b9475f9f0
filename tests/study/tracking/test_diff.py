"""All differences between two results folders are found, and no others."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.sweeps.io import write_dataset
from study.tracking import TrackingError
from study.tracking.compare import change_of, common_points
from study.tracking.diff import Comparison, compare


@pytest.fixture
def both(recorded, tmp_path):
    """Make a study before and after a change; return their comparison."""

    def both(before, after) -> Comparison:
        before()
        first = shutil.copytree(recorded.root, tmp_path / "first")
        after()
        return compare(first, recorded.root)

    return both


def test_data_and_parameters_are_compared(recorded, both) -> None:
    found = both(recorded.built, lambda: recorded.built(0.5, parameters={"press_force": 4.0}))
    assert [each.largest for each in found.data] == [0.5]
    values = {each.name: (each.before, each.after) for each in found.parameters}
    assert values["press_force"] == (3.0, 4.0)
    assert values["friction"] == (0.12, None)
    assert found.differs


def test_a_run_of_the_claims_does_not_stand_for_the_figure_of_its_name(recorded, both) -> None:
    def made(shift: float) -> None:
        recorded.built()
        with recorded.invoked():
            recorded.run_of_claims(shift)

    found = both(lambda: made(0.0), lambda: made(0.5))
    assert [(each.figure, each.largest) for each in found.data] == [("fig06", 0.5)]
    assert not found.not_compared


def test_cpu_times_are_no_results(recorded, both) -> None:
    found = both(lambda: recorded.compare("0.1"), lambda: recorded.compare("0.2"))
    assert not found.differs
    assert not found.not_compared


def test_claims_that_changed_are_listed(recorded, tmp_path: Path) -> None:
    recorded.built()
    other = shutil.copytree(recorded.root, tmp_path / "other")
    (recorded.root / "claims.csv").write_text("id,verdict\nF5a,reproduced\nF6a,mixed\n")
    (other / "claims.csv").write_text("id,verdict\nF5a,contradicted\nF6a,mixed\n")
    (claim,) = compare(recorded.root, other).claims
    assert (claim.name, claim.before, claim.after) == ("F5a", "reproduced", "contradicted")
    (other / "claims.csv").write_text("id,result\nF5a,contradicted\n")
    with pytest.raises(TrackingError, match="no column 'verdict', but id, result"):
        compare(recorded.root, other)


def test_what_cannot_be_compared_is_said(recorded, tmp_path: Path, make_dataset) -> None:
    recorded.built()
    other = tmp_path / "other" / "data"
    write_dataset(make_dataset().isel(press_force=[0]).assign_coords(press_force=[9.0]),
                  other / "fig06.nc")  # fmt: skip
    write_dataset(make_dataset(figure="fig07"), other / "fig07.nc")
    said = compare(recorded.root, other.parent).not_compared
    assert any("fig06: the two have no point in common" in each for each in said)
    assert any(each.startswith("fig07.nc: only in ") for each in said)
    with pytest.raises(TrackingError, match="is no results folder"):
        compare(recorded.root, tmp_path / "nowhere")


def test_gaps_are_counted_and_grids_are_cut_to_common_points(make_dataset) -> None:
    before, after = make_dataset(), make_dataset()
    after["tau_align"].values[:] = [[np.nan, 2.0], [3.0, 4.0]]
    change = change_of(before["tau_align"], after["tau_align"], "fig06")
    assert (change.vanished, change.appeared, change.differing) == (1, 1, 2)
    assert change.largest == 0.0
    wider = xr.concat([before, before.assign_coords(press_force=[8.0, 9.0])], "press_force")
    cut = common_points(wider, before)
    assert cut[0].sizes == cut[1].sizes == before.sizes


def test_a_trajectory_is_compared_away_from_its_jumps() -> None:
    """A jump that is 1e-9 later is no change of 1; a variable that is 1e-3 higher has changed."""

    def course(jump: float, offset: float, steps: int) -> xr.Dataset:
        before, after = np.linspace(0.0, jump, steps), np.linspace(jump, 2.0, steps)
        time = np.concatenate([before, after])
        force = np.concatenate([np.ones(steps), np.zeros(steps)]) + offset
        return xr.Dataset({"force": ("sample", force)}, {"time": ("sample", time)})

    def largest(after: xr.Dataset) -> float:
        pair = common_points(course(1.0, 0.0, 11), after)
        change = change_of(*(each["force"] for each in pair), figure="fig05")
        assert set(change.at) == {"time"}
        return change.largest

    assert largest(course(1.0 + 1e-9, 0.0, 14)) == 0.0
    assert largest(course(1.0 + 1e-9, 1e-3, 14)) == pytest.approx(1e-3)


def test_verdicts_older_than_their_data_are_not_compared(recorded, both) -> None:
    def judged() -> None:
        with recorded.invoked():
            recorded.merge()
            recorded.claims()

    found = both(judged, lambda: recorded.built(0.5))  # the claims are not judged again
    assert found.claims is None
    words = "claims.csv: not judged since data/fig06.nc changed in "
    assert f"{words}{recorded.root}: build claims.csv" in found.not_compared
    with recorded.invoked():
        recorded.claims()
    assert compare(Path(found.first), recorded.root).claims == []
