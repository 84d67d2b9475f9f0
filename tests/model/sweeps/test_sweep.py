"""Sweeps and their datasets: whole, deterministic, self-describing, and never of another study."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.physics.parameters import PARAMETER_NAMES
from model.runs.align import align
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.unvibrated import unvibrated_results
from model.sweeps.axes import points_of_chunk
from model.sweeps.io import (
    VARIABLES,
    DatasetError,
    as_characters,
    described,
    read_dataset,
    write_dataset,
)
from model.sweeps.sweep import Sweep, merge, run
from study.config import Study, load_study, study_path
from study.plans import sweep_of


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(study_path())


def small(study: Study, figure: str, counts: dict[str, int]) -> Sweep:
    spec = study.figures[figure]
    update = {
        key: getattr(spec, key).model_copy(update={"count": count}) for key, count in counts.items()
    }
    figures = {**study.figures, figure: spec.model_copy(update=update)}
    return sweep_of(study.model_copy(update={"figures": figures}), figure)


@pytest.fixture(scope="module")
def sweep(study: Study) -> Sweep:
    return small(study, "fig06", {"swept": 9})


# --- A grid, its chunks and its identity ---------------------------------------------------------


def test_a_grid_is_laid_out_slowest_dimension_first(study: Study) -> None:
    sweep = sweep_of(study, "fig06")
    family, swept = study.figures["fig06"].family, study.figures["fig06"].swept
    assert sweep.shape == (len(family.values), swept.count)
    batch = sweep.batch(np.array([0, 1, swept.count]))
    assert batch.values["tilt_stiffness"].tolist() == [family.values[i] for i in (0, 0, 1)]
    assert batch.values["press_force"].tolist() == [swept.values[i] for i in (0, 1, 0)]
    assert np.all(batch.values["frequency"] == study.figures["fig06"].held["frequency"])


@pytest.mark.parametrize("chunks", [1, 3, 7])
def test_chunks_hold_each_point_once(chunks: int) -> None:
    points = np.concatenate([points_of_chunk(100, i, chunks) for i in range(chunks)])
    assert np.array_equal(np.sort(points), np.arange(100))
    with pytest.raises(ValueError, match="must be 0 to"):
        points_of_chunk(100, chunks, chunks)


def test_identity_depends_on_numbers_and_not_on_wording(study: Study) -> None:
    for name in ("fig05", "fig13", "jamming"):
        sweep = sweep_of(study, name)
        assert Sweep.model_validate_json(sweep.model_dump_json()) == sweep
    sweep = sweep_of(study, "fig06")
    figure = study.figures["fig06"]

    def with_figure(changed) -> str:
        figures = {**study.figures, "fig06": changed}
        return sweep_of(study.model_copy(update={"figures": figures}), "fig06").identity

    assert with_figure(figure.model_copy(update={"title": "other", "chunks": 5})) == sweep.identity
    held = {**figure.held, "friction": 0.121}
    assert with_figure(figure.model_copy(update={"held": held})) != sweep.identity
    with pytest.raises(ValueError, match="fig01 is a drawing"):
        sweep_of(study, "fig01")


# --- Datasets ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def dataset(sweep: Sweep) -> xr.Dataset:
    parts = [run(sweep, chunk, 2) for chunk in (1, 0)]
    return merge(sweep, "title", parts)


def test_a_merged_grid_is_the_batch(sweep: Sweep, dataset: xr.Dataset) -> None:
    assert dataset.sizes == {"tilt_stiffness": 4, "press_force": 9}
    batch, settings = sweep.batch(np.arange(36)), sweep.settings.settings
    found = align(batch, settings)
    whole = vars(found) | unvibrated_results(batch, settings)
    whole["insertion"] = insertion_outcomes(batch, found.outcome, settings)
    for name in VARIABLES:
        expected = whole[name].reshape(4, 9)
        np.testing.assert_array_equal(dataset[name].values, expected, err_msg=name)


def test_a_dataset_describes_itself(dataset: xr.Dataset) -> None:
    assert set(dataset.data_vars) == set(VARIABLES)
    # The study starts suddenly, as the paper: at no approach speed.
    assert set(PARAMETER_NAMES) - {"approach_speed"} <= set(dataset.coords)
    for name, variable in dataset.variables.items():
        assert variable.attrs["units"] in ("1", "radian"), name
        assert variable.attrs["long_name"], name
    for name in dataset.dims:
        assert dataset[name].attrs["symbol"]
    assert dataset["outcome"].attrs["flag_values"].tolist() == [each.value for each in Outcome]
    assert dataset["outcome"].attrs["flag_meanings"].split()[0] == "aligned"
    assert described(dataset).attrs["Conventions"].startswith("CF-1")
    not_aligned = dataset["outcome"].values != Outcome.ALIGNED
    np.testing.assert_array_equal(np.isnan(dataset["tau_align"].values), not_aligned)
    assert 0 < not_aligned.sum() < not_aligned.size, "both kinds of points are tested"


def test_texts_are_characters_in_a_file(dataset: xr.Dataset, tmp_path: Path) -> None:
    """Octave's ncinfo fails on attributes of the type string."""
    write_dataset(dataset, tmp_path / "fig06.nc")
    texts = {**described(dataset).attrs, **dataset["tilt_stiffness"].attrs}
    assert not all(text.isascii() for text in texts.values() if isinstance(text, str))
    for text in as_characters(texts).values():
        assert not isinstance(text, str) or text.isascii()
    read = read_dataset(tmp_path / "fig06.nc")
    assert read.attrs == described(dataset).attrs
    assert read["tilt_stiffness"].attrs == dataset["tilt_stiffness"].attrs


def test_a_dataset_survives_the_disk_in_the_same_bytes(dataset: xr.Dataset, tmp_path: Path) -> None:
    for name in ("a.nc", "b.nc"):
        write_dataset(dataset, tmp_path / name)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "b.nc"]
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()
    stored = read_dataset(tmp_path / "a.nc")
    xr.testing.assert_identical(stored, described(dataset))
    for name in dataset.variables:
        assert stored[name].dtype == dataset[name].dtype, name


def test_chunks_of_another_sweep_or_missing_ones_are_refused(study: Study, sweep: Sweep) -> None:
    first = run(sweep, 0, 2)
    for chunks in ([first], [first, first]):
        with pytest.raises(DatasetError, match="each of 36 points once"):
            merge(sweep, "", chunks)
    foreign = run(small(study, "fig06", {"swept": 8}), 1, 2)
    with pytest.raises(DatasetError, match="belongs to sweep"):
        merge(sweep, "", [first, foreign])


def test_a_history_holds_the_drop_of_the_contact_force(fixed_study: Study) -> None:
    sweep = sweep_of(fixed_study, "fig05")
    history = merge(sweep, "title", [run(sweep)])
    assert history.attrs["summary"] == "One run over time."
    force, time = history["contact_force"].values, history["time"].values
    at_alignment = np.flatnonzero(time == history["tau_align"].item())
    assert at_alignment.size == 2, "the jump stands as two values at one time"
    assert force[at_alignment[0]] > 0.1
    assert np.all(force[at_alignment[1] :] == 0.0)
    assert int(history["separations"]) == 0, "the regime shown is the non-impact one"
