"""Figs. 13, 14: colours, hatching and borders are those of the dataset."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.patches import PathPatch

from model.events.outcomes import Outcome
from model.show import plots, style
from model.show.areas import LEFT_LABEL, PATCH_LABEL, stability_map
from model.show.axes import FAILED_LABEL, NOT_ALIGNED, NOT_INSERTED
from tests.show.drawn import NAN, followed, grid, named


@pytest.fixture
def area() -> xr.Dataset:
    durations = np.add.outer(np.linspace(2.0, 4.0, 7), np.linspace(0.0, 2.0, 9))
    durations[:, :3] = NAN
    durations[4:, 3] = NAN
    durations[2, 6] = NAN  # an island
    dataset = grid("map", "press_force", "tilt_stiffness", durations)
    dataset["outcome"][5:, 0] = Outcome.LEFT_SCENE
    dataset["outcome"][0, 1] = Outcome.FAILED
    return dataset


def centres(dataset: xr.Dataset) -> np.ndarray:
    y, x = (dataset[name].values for name in dataset["tau_align"].dims)
    return np.array([(each, row) for row in y for each in x])


def covered(patch: PathPatch, dataset: xr.Dataset) -> np.ndarray:
    inside = patch.get_path().contains_points(centres(dataset))
    return inside.reshape(dataset["tau_align"].shape)


def test_the_mesh_holds_the_durations_and_is_an_image_in_vector_files(area):
    (mesh,) = [
        each for each in stability_map(area).axes[0].collections if isinstance(each, QuadMesh)
    ]
    drawn = mesh.get_array()
    np.testing.assert_array_equal(drawn.filled(NAN), area["tau_align"].values)
    assert mesh.get_rasterized()
    # Each value stands in the middle of its cell.
    corners = mesh.get_coordinates()
    middles = 0.25 * (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1])
    np.testing.assert_allclose(middles.reshape(-1, 2), centres(area))


def test_the_hatched_area_is_where_the_part_does_not_align(area):
    (hatched,) = named(stability_map(area).axes[0].patches, NOT_ALIGNED)
    assert hatched.get_hatch() == style.NON_ALIGNING["hatch"]
    np.testing.assert_array_equal(covered(hatched, area), np.isnan(area["tau_align"].values))


def test_cells_that_left_the_scene_or_failed_can_be_told(area):
    patches = stability_map(area).axes[0].patches
    for label, outcome in (
        (LEFT_LABEL, Outcome.LEFT_SCENE),
        (FAILED_LABEL, Outcome.FAILED),
    ):
        (patch,) = named(patches, label)
        np.testing.assert_array_equal(covered(patch, area), area["outcome"].values == outcome)


def test_cells_that_align_and_do_not_go_in_are_dotted(area):
    (dots,) = named(stability_map(followed(area, [(0, 5)])).axes[0].patches, NOT_INSERTED)
    assert np.argwhere(covered(dots, area)).tolist() == [[0, 5]]
    # On the grid of the figure that a refined map shows, which has cells of its own.
    coarse = followed(area.isel(press_force=[0, 3, 6]), [(2, 8)])
    (dots,) = named(stability_map(area, coarse).axes[0].patches, NOT_INSERTED)
    assert np.argwhere(covered(dots, area)).tolist() == [[5, 8], [6, 8]]


def test_the_legend_of_a_map_names_only_what_is_there(area):
    legend = [text.get_text() for text in stability_map(area).legends[0].get_texts()]
    assert legend == [NOT_ALIGNED, LEFT_LABEL, FAILED_LABEL]
    area["outcome"][:] = Outcome.SETTLED
    legend = [text.get_text() for text in stability_map(area).legends[0].get_texts()]
    assert legend == [NOT_ALIGNED]


def test_the_border_runs_between_cells_that_differ(area):
    figure = stability_map(area)
    (border,) = [each for each in figure.axes[0].collections if isinstance(each, LineCollection)]
    gaps = np.isnan(area["tau_align"].values)
    step = {
        name: float(np.diff(area[name].values)[0]) for name in ("press_force", "tilt_stiffness")
    }
    upright = sum(abs(b[1] - a[1]) for a, b in border.get_segments()) / step["press_force"]
    level = sum(abs(b[0] - a[0]) for a, b in border.get_segments()) / step["tilt_stiffness"]
    assert upright == pytest.approx((gaps[:, 1:] != gaps[:, :-1]).sum())
    assert level == pytest.approx((gaps[1:] != gaps[:-1]).sum())


def test_axes_and_colour_bar_of_a_map_have_words_and_symbols(area):
    axes, bar = stability_map(area).axes
    assert axes.get_xlabel() == "tilt stiffness of the suspension $k_{φ}$"
    assert axes.get_ylabel() == "initial pressing force $f_{0}$"
    assert bar.get_ylabel() == "alignment duration $τ$"


def test_colours_are_logarithmic_only_where_durations_spread_and_say_so(area):
    area["tau_align"][0, 8] = 100.0
    assert stability_map(area).axes[1].get_ylabel().endswith("logarithmic")


def test_a_map_of_200_by_200_cells_with_islands_stays_small(tmp_path):
    rng = np.random.default_rng(7)
    durations = np.add.outer(np.linspace(2.0, 4.0, 200), np.linspace(0.0, 40.0, 200))
    durations[:, :60] = NAN
    durations[rng.random(durations.shape) < 0.01] = NAN
    figure = plots.draw(grid("map", "frequency", "tilt_stiffness", durations))
    for path in style.save(figure, tmp_path / "map"):
        assert path.stat().st_size < 1_000_000, path.name


@pytest.mark.parametrize("value", [NAN, 3.0])
def test_a_map_may_align_nowhere_or_everywhere(area, value, tmp_path):
    area["tau_align"][:] = value
    style.save(stability_map(area), tmp_path / "map")


def test_a_patch_is_hatched_and_has_no_border(area):
    patch = np.zeros(area["tau_align"].shape, dtype=np.int8)
    area["patch"] = (area["tau_align"].dims, patch)
    axes = stability_map(area).axes[0]
    assert not named(axes.patches, PATCH_LABEL)
    (before,) = named(axes.collections, "_border")
    area["patch"][1:4, 5:8] = 1  # around the island
    axes = stability_map(area).axes[0]
    (hatched,) = named(axes.patches, PATCH_LABEL)
    np.testing.assert_array_equal(covered(hatched, area), area["patch"].values == 1)
    (border,) = named(axes.collections, "_border")
    assert len(before.get_segments()) - len(border.get_segments()) == 4  # the island's
