"""Datasets: whole, deterministic, self-describing, and never of another study."""

import hashlib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.physics.parameters import PARAMETER_NAMES
from model.runs.align import align
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.unvibrated import unvibrated_results
from model.study.config import load_study, study_path
from model.study.datasets import (
    VARIABLES,
    DatasetError,
    compute_chunk,
    history_dataset,
    merge_chunks,
    read_dataset,
    write_dataset,
)
from model.study.sweeps import Sweep, sweep_of


def small(figure: str, counts: dict[str, int]) -> Sweep:
    study = load_study(study_path())
    spec = study.figures[figure]
    update = {
        key: getattr(spec, key).model_copy(update={"count": count}) for key, count in counts.items()
    }
    figures = {**study.figures, figure: spec.model_copy(update=update)}
    return sweep_of(study.model_copy(update={"figures": figures}), figure)


@pytest.fixture(scope="module")
def sweep() -> Sweep:
    return small("fig06", {"swept": 9})


@pytest.fixture(scope="module")
def dataset(sweep: Sweep) -> xr.Dataset:
    parts = [compute_chunk(sweep, chunk, 2) for chunk in (1, 0)]
    return merge_chunks(sweep, "title", "summary", parts)


def test_a_merged_grid_is_the_batch(sweep: Sweep, dataset: xr.Dataset) -> None:
    assert dataset.sizes == {"tilt_stiffness": 5, "press_force": 9}
    batch, settings = sweep.batch(np.arange(45)), sweep.settings.settings
    found = align(batch, settings)
    whole = vars(found) | unvibrated_results(batch, settings)
    whole["insertion"] = insertion_outcomes(batch, found.outcome, settings)
    for name in VARIABLES:
        expected = whole[name].reshape(5, 9)
        np.testing.assert_array_equal(dataset[name].values, expected, err_msg=name)


def test_a_dataset_describes_itself(dataset: xr.Dataset) -> None:
    assert set(dataset.data_vars) == set(VARIABLES)
    assert set(PARAMETER_NAMES) <= set(dataset.coords)
    for name, variable in dataset.variables.items():
        assert variable.attrs["units"] in ("1", "rad"), name
        assert variable.attrs["long_name"], name
    for name in dataset.dims:
        assert dataset[name].attrs["symbol"]
    assert dataset["outcome"].attrs["flag_values"].tolist() == [each.value for each in Outcome]
    assert dataset["outcome"].attrs["flag_meanings"].split()[0] == "aligned"
    assert dataset.attrs["Conventions"].startswith("CF-1")
    not_aligned = dataset["outcome"].values != Outcome.ALIGNED
    np.testing.assert_array_equal(np.isnan(dataset["tau_align"].values), not_aligned)
    assert 0 < not_aligned.sum() < not_aligned.size, "both kinds of points are tested"


def test_the_same_content_gives_the_same_bytes(dataset: xr.Dataset, tmp_path: Path) -> None:
    for name in ("a.nc", "b.nc"):
        write_dataset(dataset, tmp_path / name)
    hashes = {hashlib.sha256(path.read_bytes()).hexdigest() for path in tmp_path.iterdir()}
    assert len(hashes) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "b.nc"]


def test_a_dataset_survives_the_disk(dataset: xr.Dataset, tmp_path: Path) -> None:
    write_dataset(dataset, tmp_path / "a.nc")
    stored = read_dataset(tmp_path / "a.nc")
    xr.testing.assert_identical(stored, dataset)
    for name in dataset.variables:
        assert stored[name].dtype == dataset[name].dtype, name


def test_chunks_of_another_sweep_or_missing_ones_are_refused(sweep: Sweep) -> None:
    first = compute_chunk(sweep, 0, 2)
    with pytest.raises(DatasetError, match="each of 45 points once"):
        merge_chunks(sweep, "", "", [first])
    with pytest.raises(DatasetError, match="each of 45 points once"):
        merge_chunks(sweep, "", "", [first, first])
    foreign = compute_chunk(small("fig06", {"swept": 8}), 1, 2)
    with pytest.raises(DatasetError, match="belongs to sweep"):
        merge_chunks(sweep, "", "", [first, foreign])


def test_a_file_that_is_no_dataset_is_refused(dataset: xr.Dataset, tmp_path: Path) -> None:
    whole = tmp_path / "whole.nc"
    write_dataset(dataset, whole)
    truncated = tmp_path / "truncated.nc"
    truncated.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    text = tmp_path / "text.nc"
    text.write_text("not netCDF")
    foreign = tmp_path / "foreign.nc"
    xr.Dataset({"a": ("b", [1.0])}).to_netcdf(foreign)
    for path in (truncated, text, foreign, tmp_path / "absent.nc"):
        with pytest.raises(DatasetError, match=path.name):
            read_dataset(path)


def test_a_history_holds_the_drop_of_the_contact_force() -> None:
    history = history_dataset(sweep_of(load_study(study_path()), "fig05"), "title", "summary")
    force, time = history["contact_force"].values, history["time"].values
    at_alignment = np.flatnonzero(time == history["tau_align"].item())
    assert at_alignment.size == 2, "the jump stands as two values at one time"
    assert force[at_alignment[0]] > 0.1
    assert np.all(force[at_alignment[1] :] == 0.0)
    assert int(history["separations"]) == 0, "the regime shown is the non-impact one"
