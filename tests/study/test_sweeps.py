"""A figure's computation: its grid, its chunks and its identity."""

import numpy as np
import pytest

from model.study.config import load_study, study_path
from model.study.sweeps import Sweep, sweep_of


@pytest.fixture
def study():
    return load_study(study_path())


def test_a_grid_is_laid_out_slowest_dimension_first(study) -> None:
    sweep = sweep_of(study, "fig06")
    family, swept = study.figures["fig06"].family, study.figures["fig06"].swept
    assert sweep.shape == (len(family.values), swept.count)
    batch = sweep.batch(np.array([0, 1, swept.count]))
    assert batch.values["tilt_stiffness"].tolist() == [
        family.values[0], family.values[0], family.values[1],
    ]  # fmt: skip
    assert batch.values["press_force"].tolist() == [
        swept.values[0], swept.values[1], swept.values[0],
    ]  # fmt: skip
    assert np.all(batch.values["frequency"] == study.figures["fig06"].held["frequency"])


@pytest.mark.parametrize("chunks", [1, 3, 7])
def test_chunks_hold_each_point_once(study, chunks: int) -> None:
    sweep = sweep_of(study, "fig11")
    points = np.concatenate([sweep.points_of_chunk(i, chunks) for i in range(chunks)])
    assert np.array_equal(np.sort(points), np.arange(np.prod(sweep.shape)))
    with pytest.raises(ValueError, match="must be 0 to"):
        sweep.points_of_chunk(chunks, chunks)


def test_identity_depends_on_numbers_and_not_on_wording(study) -> None:
    sweep = sweep_of(study, "fig06")
    assert Sweep.model_validate_json(sweep.model_dump_json()) == sweep
    figure = study.figures["fig06"]

    def with_figure(changed) -> str:
        figures = {**study.figures, "fig06": changed}
        return sweep_of(study.model_copy(update={"figures": figures}), "fig06").identity

    assert with_figure(figure.model_copy(update={"title": "other", "chunks": 5})) == sweep.identity
    held = {**figure.held, "friction": 0.121}
    assert with_figure(figure.model_copy(update={"held": held})) != sweep.identity


def test_a_drawing_has_no_sweep(study) -> None:
    with pytest.raises(ValueError, match="fig01 is a drawing"):
        sweep_of(study, "fig01")
