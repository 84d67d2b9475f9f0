"""The reference: allowed and refused differences of a build, and acceptance of new results."""

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.engine.tolerances import MARGIN
from model.events.outcomes import Outcome, Unvibrated
from model.sweeps.io import write_dataset
from model.sweeps.sweep import merge, run
from study.config import load_study, study_path
from study.plans import sweep_of
from study.tracking import TrackingError
from study.tracking.reference import LOG, LOG_COLUMNS, accept, compare_with_reference, verify

ERROR = 1e-8
CLAIM = "claim,verdict,place,says,seen,fails,random\nL01,{},sect. 3,aligns,1,,0.1\n"


def curves() -> xr.Dataset:
    """Ten curves of ten points: two points do not align, one is sensitive."""
    dims = ("tilt_stiffness", "press_force")
    tau = np.linspace(1.0, 9.0, 100).reshape(10, 10)
    tau[0, :2] = np.nan
    gaps = np.isnan(tau)
    sensitive = np.zeros((10, 10), dtype=np.int8)
    sensitive[5, 5] = 1
    numbers = {
        "tau_align": tau,
        "tau_error": np.where(gaps, np.nan, ERROR),
        "tau_corners_inside": tau + 0.1,
        "tilt_at_alignment": 0.01 * tau,
        "tilt_max": np.full((10, 10), 0.3),
        "contact_force_max": np.full((10, 10), 4.0),
        "sticking_share": np.full((10, 10), 0.2),
        "outcome": np.where(gaps, Outcome.SETTLED, Outcome.ALIGNED).astype(np.int8),
        "reason": np.zeros((10, 10), dtype=np.int8),
        "sensitive": sensitive,
        "separations": np.zeros((10, 10), dtype=np.int32),
        "unvibrated": np.full((10, 10), Unvibrated.RESTS, dtype=np.int8),
        "unvibrated_tilt": np.full((10, 10), 0.1),
        "slow_tilt": np.full((10, 10), 0.1),
    }
    return xr.Dataset(
        {name: (dims, values) for name, values in numbers.items()},
        {"tilt_stiffness": np.arange(1.0, 11.0), "press_force": np.arange(10.0), "friction": 0.12},
        {"figure": "fig06", "config_hash": "0", "kind": "curves"},
    )


def found(**changes: dict[tuple[int, int], float]) -> list[str]:
    """Return the variables that differ after points of the built dataset are changed."""
    built = curves()
    for name, points in changes.items():
        for place, value in points.items():
            built[name].values[place] = value
    return [each.variable for each in compare_with_reference(curves(), built)]


def test_a_twin_may_rest_a_little_elsewhere_and_not_end_otherwise() -> None:
    assert found(unvibrated_tilt={(1, 1): 0.1005}, slow_tilt={(1, 1): 0.0995}) == []
    assert found(unvibrated_tilt={(1, 1): 0.102}) == ["unvibrated_tilt"]
    assert found(slow_tilt={(1, 1): np.nan}) == ["slow_tilt"]
    assert found(unvibrated={(1, 1): Unvibrated.ALIGNS}) == ["unvibrated"]


@pytest.mark.parametrize(
    "name", ["tau_align", "tau_corners_inside", "tilt_at_alignment", "sticking_share"]
)
def test_a_point_may_differ_by_its_own_error_and_not_by_more(name: str) -> None:
    value = float(curves()[name][3, 3])
    assert found(**{name: {(3, 3): value + 0.99 * MARGIN * ERROR}}) == []
    assert found(**{name: {(3, 3): value + 1.2 * MARGIN * ERROR + 1e-8}}) == [name]
    assert found(**{name: {(3, 3): np.nan}}) == [name], "a number does not just vanish"


def test_the_error_that_a_build_states_buys_it_nothing() -> None:
    built = curves()
    built["tau_error"][:, :] = 1.0
    built["tau_align"][3, 3] += 1e-3
    (finding,) = compare_with_reference(curves(), built)
    assert finding.variable == "tau_align"
    assert finding.points == 1
    assert "(1.0e-07 allowed) at tilt_stiffness = 4, press_force = 3" in finding.words


def test_peaks_may_differ_by_where_steps_end() -> None:
    assert found(tilt_max={(3, 3): 0.3 + 5e-5}, contact_force_max={(3, 3): 4.05}) == []
    assert found(tilt_max={(3, 3): 0.301}) == ["tilt_max"]
    assert found(contact_force_max={(3, 3): 4.1}) == ["contact_force_max"]


def test_a_share_is_exact_to_the_horizon_and_loose_where_a_run_settles() -> None:
    reference, built = curves(), curves()
    for dataset in (reference, built):
        dataset["outcome"].values[0, 0] = Outcome.HORIZON_REACHED
    built["sticking_share"].values[0, :2] += 1e-3  # the second of them settled
    (finding,) = compare_with_reference(reference, built)
    assert (finding.variable, finding.points) == ("sticking_share", 1)
    built["sticking_share"].values[0, 0] = 0.2 + 1e-8
    assert compare_with_reference(reference, built) == []


def test_an_outcome_may_flip_only_where_the_reference_is_sensitive() -> None:
    assert found(outcome={(5, 5): Outcome.SETTLED}, tau_align={(5, 5): np.nan}) == []
    assert found(outcome={(3, 3): Outcome.SETTLED}, tau_align={(3, 3): np.nan}) == ["outcome"]
    assert found(reason={(3, 3): 1}) == ["reason"]
    assert found(separations={(3, 3): 1}) == ["separations"]


def test_a_build_cannot_call_its_points_sensitive_to_be_let_through() -> None:
    flags = dict.fromkeys([(3, 3), (4, 4)], 1)
    assert found(sensitive=flags) == []
    moved = found(sensitive={(3, 3): 1}, tau_align={(3, 3): 1.0})
    assert moved == ["tau_align"]
    assert found(sensitive={**flags, (6, 6): 1}) == ["sensitive"]


def test_other_parameters_are_no_comparison() -> None:
    built = curves().assign_coords(friction=0.13)
    (finding,) = compare_with_reference(curves(), built)
    assert finding.variable == "parameters"
    assert finding.words.endswith("parameters: friction")
    shorter = curves().isel(press_force=slice(9))
    assert compare_with_reference(curves(), shorter)[0].variable == "parameters"


def test_a_trajectory_is_compared_in_its_course() -> None:
    study = load_study(study_path())
    usual = sweep_of(study, "fig05")
    reference = merge(usual, "t", [run(usual)])
    settings = study.settings.model_copy(update={"tolerance": 1e-12})
    finer = sweep_of(study.model_copy(update={"settings": settings}), "fig05")
    # Another sequence of steps is no other course.
    assert compare_with_reference(reference, merge(finer, "t", [run(finer)])) == []
    for name in ("x", "tilt", "contact_force"):
        built = reference.copy(deep=True)
        built[name].values[:] += 0.01 * np.ptp(built[name].values)
        assert [each.variable for each in compare_with_reference(reference, built)] == [name]


# --- Accepting ----------------------------------------------------------------------------------


@pytest.fixture
def root(tmp_path: Path) -> Path:
    write_dataset(curves(), tmp_path / "results/data/fig06.nc")
    (tmp_path / "results/figures").mkdir()
    for name in ("fig01", "fig06"):
        (tmp_path / f"results/figures/{name}.png").write_bytes(b"picture")
    (tmp_path / "results/claims.csv").write_text(CLAIM.format("shown"))
    return tmp_path / "results"


def log(folder: Path) -> list[dict[str, str]]:
    with (folder / LOG).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_accepting_makes_a_red_build_green_and_logs_the_numbers(root: Path, tmp_path: Path) -> None:
    reference = tmp_path / "reference"
    assert [each.variable for each in verify(root, reference, ["fig06"])] == ["dataset"]
    accept(root, reference, {"fig06": True, "fig01": False}, "the first reference")
    assert verify(root, reference, ["fig06"]) == []
    changed = curves()
    changed["tau_align"][3, 3] += 0.25
    write_dataset(changed, root / "data/fig06.nc")
    assert [each.variable for each in verify(root, reference, ["fig06"])] == ["tau_align"]
    accept(root, reference, {"fig06": True}, "a longer spring")
    assert verify(root, reference, ["fig06"]) == []
    first, picture, line = log(reference)
    assert tuple(line) == LOG_COLUMNS
    assert (first["changed"], picture["what"]) == ("(first)", "fig01")
    assert line["reason"] == "a longer spring"
    assert line["changed"] == "tau_align at 1 of 100 by 0.25"


def test_claims_are_part_of_the_reference(root: Path, tmp_path: Path) -> None:
    reference = tmp_path / "reference"
    accept(root, reference, {"claims": False, "fig06": True}, "the first reference")
    (root / "claims.csv").write_text(CLAIM.format("not shown"))
    (finding,) = verify(root, reference, ["fig06"])
    assert (finding.variable, finding.words) == ("L01", "shown became not shown")
    accept(root, reference, {"claims": False}, "read again in the paper")
    assert verify(root, reference, ["fig06"]) == []
    assert log(reference)[-1]["changed"] == "L01"
    (root / "claims.csv").unlink()
    assert "is missing" in verify(root, reference, ["fig06"])[0].words


def test_nothing_is_accepted_without_a_reason_or_a_build(root: Path, tmp_path: Path) -> None:
    reference = tmp_path / "reference"
    for reason in ("", "  ", "ok"):
        with pytest.raises(TrackingError, match="say in a few words why"):
            accept(root, reference, {"fig06": True}, reason)
    with pytest.raises(TrackingError, match=r"fig07\.nc is missing"):
        accept(root, reference, {"fig06": True, "fig07": True}, "the first reference")
    assert not reference.exists(), "nothing of it is accepted then"
