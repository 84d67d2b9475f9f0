"""Maps: what no accepted picture of test_pictures.py shows, as maps of devices in SI units."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from model.events.outcomes import Outcome, Unvibrated
from study.plots import draw
from tests.vibralign.plots.drawn import NAN, grid, named
from vibralign.answers.si import readable
from vibralign.plots import style
from vibralign.plots.maps import (
    ADDED_LABELS,
    RELIABLE_LABEL,
    SLOW_LABEL,
    round_levels,
    stability_map,
    vibration_map,
)
from vibralign.plots.style import NOT_ALIGNED

CELLS = 32


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


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize("value", [NAN, 3.0])
def test_a_map_may_align_nowhere_or_everywhere(area, value, tmp_path):
    area["tau_align"][:] = value
    style.write(stability_map(area), tmp_path / "map.pdf")


# --- Contours, outlines and marks -----------------------------------------------------------------


def dataset(reliable=True, unvibrated=False) -> xr.Dataset:
    """A map that aligns to the right of a slanting border, reliably a little further in."""
    x, y = np.linspace(1.0, 30.0, CELLS + 1), np.linspace(0.25, 10.0, CELLS + 1)
    right = x[None, :] - 2.0 * y[:, None]
    aligns, sure = right > 0.0, right > 4.0
    tau = np.where(aligns, 2.0 + 60.0 / (1.0 + np.abs(right)), np.nan)
    outcome = np.where(aligns, Outcome.ALIGNED, Outcome.SETTLED).astype(np.int8)
    dims = ("press_force", "tilt_stiffness")
    starts = ("start_press_force", "start_tilt_stiffness")
    variables = {
        "tau_align": (dims, tau),
        "outcome": (dims, outcome),
        "reliable": (starts, (sure & reliable)[::4, ::4].astype(np.int8)),
    }
    if unvibrated:  # without vibration it aligns below f0 = 5, on either side of the border
        ends = np.where(y < 5.0, Unvibrated.ALIGNS, Unvibrated.RESTS)
        ends = np.repeat(ends.astype(np.int8)[:, None], x.size, axis=1)
        variables["unvibrated"] = (dims, ends)
        variables["slow_tilt"] = (dims, np.where(right < 10.0, 0.1, np.nan))
    coordinates = {
        "tilt_stiffness": ("tilt_stiffness", x, {"long_name": "tilt stiffness", "symbol": "k_φ"}),
        "press_force": ("press_force", y, {"long_name": "pressing force", "symbol": "f0"}),
    }
    coordinates |= {
        name: (name, {"start_press_force": y, "start_tilt_stiffness": x}[name][::4])
        for name in starts
    }
    return xr.Dataset(variables, coordinates, {"kind": "map"})


def test_where_starts_are_tried_at_every_node_the_reliable_area_is_outlined():
    shown = dataset()
    sure = shown["outcome"].copy(data=(shown["tau_align"].values < 10.0).astype(np.int8))
    figure = draw(shown.drop_vars("reliable").assign(reliable=sure))
    assert words(figure) == [NOT_ALIGNED, RELIABLE_LABEL]


def test_what_vibration_adds_is_shown_as_four_areas():
    shown = dataset(unvibrated=True)
    figure = vibration_map(shown)
    assert words(figure) == [*ADDED_LABELS, SLOW_LABEL]
    outcome, ends = shown["outcome"].values, shown["unvibrated"].values
    y, x = (shown[name].values for name in shown["tau_align"].dims)
    nodes = [(each, row) for row in y for each in x]
    for label, vibrated, pressed in zip(
        ADDED_LABELS, (True, True, False, False), (True, False, True, False), strict=True
    ):
        (drawn,) = named(figure.axes[0].patches, label)
        covered = drawn.get_path().contains_points(nodes).reshape(outcome.shape)
        expected = (outcome == Outcome.ALIGNED) == vibrated
        expected &= (ends == Unvibrated.ALIGNS) == pressed
        np.testing.assert_array_equal(covered, expected, err_msg=label)


def test_what_is_not_there_has_no_entry_in_the_legend():
    shown = dataset(reliable=False)
    shown["tau_align"][:] = 2.0
    shown["outcome"][:] = Outcome.ALIGNED
    assert words(draw(shown)) == []


@pytest.mark.parametrize(
    "values",
    [np.linspace(2.0, 9.0, 500), np.geomspace(1.0, 300.0, 500), np.linspace(-3.0, 3.0, 500)],
)
def test_contours_are_at_round_numbers_inside_the_values(values):
    levels = round_levels(values)
    assert 2 <= len(levels) <= 9
    assert values[0] < min(levels) < max(levels) < values[-1]
    assert all(float(f"{level:.2g}") == level for level in levels)


def test_a_map_in_si_units_is_drawn_as_it_is_read_and_stays_in_si_units():
    """Lengths in mm, or in µm if they are small; a coarser grid in the unit of the finer one."""
    fine, coarse = np.linspace(20e-6, 100e-6, 9), np.linspace(20e-6, 90e-6, 3)
    meter, newton = {"units": "m", "long_name": "misalignment"}, {"units": "N", "symbol": "f_0"}
    coordinates = {
        "press_force": ("press_force", np.linspace(500.0, 2000.0, 4), newton),
        "misalignment": ("misalignment", fine, meter),
        "start_misalignment": ("start_misalignment", coarse, meter),
        "half_width": ((), 5e-3, {"units": "m"}),
    }
    place = ("press_force", "misalignment")
    outcome = np.full((4, 9), int(Outcome.ALIGNED), np.int8)
    variables = {
        "outcome": (place, outcome),
        "tau_align": (place, np.linspace(0.1, 0.4, 36).reshape(4, 9), {"units": "s"}),
    }
    dataset = xr.Dataset(variables, coordinates, {"kind": "map"})
    before = dataset.copy(deep=True)
    shown = readable(dataset)
    xr.testing.assert_identical(dataset, before)
    units = {name: shown[name].attrs.get("units") for name in shown.variables}
    assert units == {"press_force": "kN", "misalignment": "mm", "start_misalignment": "mm",
                     "half_width": "mm", "outcome": None, "tau_align": "ms"}  # fmt: skip
    np.testing.assert_allclose(shown.start_misalignment, [0.02, 0.055, 0.09])
    axes = stability_map(dataset).axes
    assert axes[0].get_xlabel() == "misalignment (mm)"
    assert axes[0].get_ylabel().endswith("force (kN)")
    assert axes[1].get_ylabel().endswith(" in ms")
    low, high = axes[0].get_xlim()
    assert (low, high) == pytest.approx((0.015, 0.105))
    small = readable(dataset.sel(misalignment=slice(0.0, 95e-6)))
    assert small.misalignment.attrs["units"] == "µm"
    assert small.start_misalignment.values.tolist() == pytest.approx([20.0, 55.0, 90.0])


@pytest.mark.parametrize(("scene", "verb"), [("alignment", "aligns"), ("insertion", "goes in")])
def test_the_legend_of_a_map_fits_its_page(scene, verb):
    shown = dataset(unvibrated=True).assign_attrs(scene=scene)
    if scene == "insertion":
        aligned = shown["outcome"] == Outcome.ALIGNED
        shown["outcome"] = shown["outcome"].where(~aligned, Outcome.INSERTED)
    figure = stability_map(shown)
    figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert figure.bbox.x0 <= box.x0
    assert box.x1 <= figure.bbox.x1
    assert f"{verb} from every start, where these are tried" in words(figure)


def test_labels_of_contours_that_lie_close_together_do_not_cover_each_other():
    columns = np.linspace(0.0, 1.0, 33)
    durations = np.tile(1.0 + 5.0 * np.clip(32.0 * columns - 16.0, 0.0, 1.0), (9, 1))
    axes = stability_map(grid("map", "press_force", "tilt_stiffness", durations)).axes[0]
    assert len(round_levels(durations.ravel())) > len(axes.texts) == 1
