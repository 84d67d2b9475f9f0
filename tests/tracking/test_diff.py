"""All differences between two states are found, and no others."""

import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.sweeps.io import write_dataset
from model.tracking import TrackingError, invocation
from model.tracking.compare import change_of, common_points
from model.tracking.diff import Comparison, compare, snapshot
from model.tracking.history import kept_result
from model.tracking.invocation import Invocation


def found(recorded, *names: str) -> Comparison:
    return compare(*(snapshot(name, recorded.root) for name in names))


def test_earlier_invocations_and_runs_are_compared_by_what_is_kept(recorded) -> None:
    names = recorded.built(), recorded.built(0.5, parameters={"press_force": 4.0})
    for given in (names, [f"merge/fig06@{name}" for name in names]):
        difference = found(recorded, *given)
        assert [each.largest for each in difference.data] == [0.5]
        values = {each.name: (each.before, each.after) for each in difference.parameters}
        assert values["press_force"] == (3.0, 4.0)
        assert values["friction"] == (0.12, None)


def test_a_run_of_the_claims_does_not_stand_for_the_figure_of_its_name(recorded) -> None:
    names = []
    for shift in (0.0, 0.5):
        with recorded.invoked() as invocation:
            recorded.merge(shift)
            recorded.run_of_claims()
        names.append(invocation.name)
    difference = found(recorded, *names)
    assert [each.largest for each in difference.data] == [0.5]
    assert not difference.not_compared


def test_data_that_are_no_figures_differ_by_their_bytes(recorded) -> None:
    names = []
    for shift in (0.0, 0.0, 0.5):
        with recorded.invoked() as invocation:
            recorded.run_of_claims(shift)
        names.append(f"claims_runs/fig06@{invocation.name}")
    assert not found(recorded, *names[:2]).differs
    difference = found(recorded, names[0], names[2])
    assert difference.other_data == ["claims_runs/fig06: fig06.nc"]
    assert difference.differs


def test_cpu_times_are_no_results(recorded) -> None:
    names = []
    for times in ("0.1", "0.2"):
        with recorded.invoked() as invocation:
            recorded.compare(times)
        names.append(invocation.name)
    difference = found(recorded, *names)
    assert not difference.differs
    assert not difference.not_compared
    assert not (recorded.root / "history/data").exists(), "no copies are kept of them"


def test_an_invocation_stands_for_all_that_stood_when_it_ended(recorded) -> None:
    with recorded.invoked():
        recorded.merge()
        recorded.merge(figure="fig07")
    second = snapshot(recorded.built(0.5), recorded.root)
    assert set(second.runs) == {"merge/fig06", "merge/fig07"}
    assert set(second.files) == {"fig06.nc", "fig07.nc"}


def test_a_commit_stands_for_the_last_invocation_at_it(recorded, monkeypatch) -> None:
    for commit, shift in (("aaaa1111", 0.0), ("bbbb2222", 0.5)):
        state = {"commit": commit, "dirty": False}
        monkeypatch.setattr(invocation, "git_state", lambda state=state: state)
        recorded.built(shift)
    assert [each.largest for each in found(recorded, "aaaa", "bbbb2222").data] == [0.5]
    with pytest.raises(TrackingError, match="git worktree add"):
        snapshot("cccc3333", recorded.root)
    with pytest.raises(TrackingError, match="'2' is the beginning of 2"):
        snapshot("2", recorded.root)
    monkeypatch.setattr(invocation, "git_state", lambda: {"commit": "dddd4444", "dirty": False})
    Invocation(recorded.root).record_idle("failed", "the configuration breaks a rule")
    with pytest.raises(TrackingError, match="'dddd' is no results folder"):
        snapshot("dddd", recorded.root)


def test_claims_that_changed_are_listed(recorded, tmp_path: Path) -> None:
    recorded.built()
    other = tmp_path / "other"
    shutil.copytree(recorded.root, other)
    (recorded.root / "claims.csv").write_text("id,verdict\nF5a,reproduced\nF6a,mixed\n")
    (other / "claims.csv").write_text("id,verdict\nF5a,contradicted\nF6a,mixed\n")
    names = str(recorded.root), str(other)
    (claim,) = found(recorded, *names).claims
    assert (claim.name, claim.before, claim.after) == ("F5a", "reproduced", "contradicted")
    (other / "claims.csv").write_text("id,result\nF5a,contradicted\n")
    with pytest.raises(TrackingError, match="no column 'verdict', but id, result"):
        found(recorded, *names)


def test_what_cannot_be_compared_is_said(recorded, tmp_path: Path, make_dataset) -> None:
    recorded.built()
    other = tmp_path / "other" / "data"
    write_dataset(make_dataset().isel(press_force=[0]).assign_coords(press_force=[9.0]),
                  other / "fig06.nc")  # fmt: skip
    write_dataset(make_dataset(figure="fig07"), other / "fig07.nc")
    said = found(recorded, str(recorded.root), str(other.parent)).not_compared
    assert any("fig06: the two have no point in common" in each for each in said)
    assert any(each.startswith("fig07.nc: only in ") for each in said)
    kept = kept_result(recorded.root, "fig06.nc", "")
    shutil.rmtree(kept.parent)
    lost = found(recorded, "last", "last").not_compared
    assert any("no copy is kept" in each for each in lost)


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


def test_verdicts_older_than_their_data_are_not_compared(recorded) -> None:
    with recorded.invoked() as first:
        recorded.merge()
        recorded.claims()
    second = recorded.built(0.5)  # a figure alone: the claims are not judged again
    difference = found(recorded, first.name, second)
    assert difference.claims is None
    words = f"claims.csv: not judged since data/fig06.nc changed in {second}: build claims.csv"
    assert words in difference.not_compared
    with recorded.invoked() as again:
        recorded.claims()
    assert found(recorded, first.name, again.name).claims == []
