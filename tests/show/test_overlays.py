"""Overlays of a stability map, read back from its artists."""

import itertools
import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure

from model.events.outcomes import Outcome, Unvibrated
from model.show.areas import ADDED_LABELS, SLOW_LABEL, vibration_map
from model.show.axes import NOT_ALIGNED
from model.show.overlays import MARK_LABEL, RELIABLE_LABEL, VIBRATION_LABEL, round_levels
from model.show.plots import draw

CELLS = 32


def dataset(marks=(), reliable=True, unvibrated=False) -> xr.Dataset:
    """A map that aligns to the right of a slanting border, reliably a little further in."""
    x, y = np.linspace(1.0, 30.0, CELLS + 1), np.linspace(0.25, 10.0, CELLS + 1)
    right = x[None, :] - 2.0 * y[:, None]
    aligns, sure = right > 0.0, right > 4.0
    tau = np.where(aligns, 2.0 + 60.0 / (1.0 + np.abs(right)), np.nan)
    outcome = np.where(aligns, Outcome.ALIGNED, Outcome.SETTLED).astype(np.int8)
    dims = ("press_force", "tilt_stiffness")
    variables = {
        "tau_align": (dims, tau),
        "outcome": (dims, outcome),
        "reliable": (dims, (sure & reliable).astype(np.int8)),
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
    attributes = {
        "kind": "map",
        "resolution": CELLS,
        "ensemble_phases": [0.0, 1.0],
        "operating_points": json.dumps(list(marks)),
    }
    return xr.Dataset(variables, coordinates, attributes)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def contours(figure: Figure, label: str) -> list[QuadContourSet]:
    return [
        each
        for each in figure.axes[0].collections
        if isinstance(each, QuadContourSet) and each.get_label() == label
    ]


def test_a_map_shows_areas_contours_and_the_reliable_area():
    shown = dataset()
    figure = draw(shown)
    assert words(figure) == [NOT_ALIGNED, RELIABLE_LABEL]
    (outline,) = contours(figure, f"_{RELIABLE_LABEL}")
    x, y = (shown[name].values for name in ("tilt_stiffness", "press_force"))
    for across, up in np.concatenate([path.vertices for path in outline.get_paths()]):
        assert across - 2.0 * up == pytest.approx(4.0, abs=2.0 * (x[1] - x[0]))
    assert len(y) == CELLS + 1
    (lines,) = contours(figure, "_contours")
    assert len(lines.labelTexts) >= 2
    tau = shown["tau_align"].values
    assert all(np.nanmin(tau) < level < np.nanmax(tau) for level in lines.levels)


def test_the_area_that_needs_vibration_is_outlined():
    shown = dataset(unvibrated=True)
    figure = draw(shown)
    assert VIBRATION_LABEL in words(figure)
    (outline,) = contours(figure, f"_{VIBRATION_LABEL}")
    low = np.concatenate([path.vertices for path in outline.get_paths()])[:, 1].min()
    assert low == pytest.approx(5.0, abs=10.0 / CELLS)


def test_what_vibration_adds_is_shown_as_four_areas():
    shown = dataset(unvibrated=True)
    figure = vibration_map(shown)
    assert words(figure) == [*ADDED_LABELS, SLOW_LABEL]
    outcome, ends = shown["outcome"].values, shown["unvibrated"].values
    x, y = (shown[name].values for name in ("tilt_stiffness", "press_force"))
    centres = np.column_stack([each.ravel() for each in np.meshgrid(x, y)])
    areas = {each.get_label(): each for each in figure.axes[0].patches}
    for label, vibrated, pressed in zip(
        ADDED_LABELS, (True, True, False, False), (True, False, True, False), strict=True
    ):
        drawn = areas[label].get_path().contains_points(centres).reshape(outcome.shape)
        expected = ((outcome == Outcome.ALIGNED) == vibrated) & (
            (ends == Unvibrated.ALIGNS) == pressed
        )
        np.testing.assert_array_equal(drawn, expected, err_msg=label)


def test_without_reliability_there_is_no_outline():
    assert contours(draw(dataset(reliable=False)), f"_{RELIABLE_LABEL}") == []
    without = dataset()
    del without.attrs["ensemble_phases"]
    assert RELIABLE_LABEL not in words(draw(without))


def test_operating_points_are_those_of_the_other_figures():
    marks = [
        ("fig05", [20.0], [1.5]),
        ("fig06", [10.0], [0.25, 10.0]),
        ("fig07", [20.0], [1.5]),
        ("fig08", [1.0, 30.0], [3.0]),
        ("fig09", [99.0], [3.0]),
    ]
    figure = draw(dataset(marks))
    assert MARK_LABEL in words(figure)
    axes = figure.axes[0]
    places = {text.get_text(): text.xy for text in axes.texts if hasattr(text, "xy")}
    assert places["5, 7"] == (20.0, 1.5)
    assert places["6"] == (10.0, 10.0)
    assert places["8"] == (30.0, 3.0)
    assert not {"9", "5", "7"} & set(places)
    swept = {str(line.get_label()): line for line in axes.lines}
    assert swept["_swept fig06"].get_xdata().tolist() == [10.0, 10.0]
    assert swept["_swept fig06"].get_ydata().tolist() == [0.25, 10.0]
    assert "_swept fig05" not in swept


def test_numbers_of_ranges_move_along_their_lines_to_free_places():
    marks = [
        ("fig06", [10.0], [0.25, 10.0]),
        ("fig12", [9.7], [0.25, 10.0]),
        ("fig07", [10.0], [9.5]),
        ("fig08", [20.0], [0.25, 10.0]),
    ]
    axes = draw(dataset(marks)).axes[0]
    places = {text.get_text(): text.xy for text in axes.texts if hasattr(text, "xy")}
    assert places["7"] == (10.0, 9.5)
    assert places["8"] == (20.0, 10.0)
    assert (places["6"][0], places["12"][0]) == (10.0, 9.7)
    shares = {
        name: np.subtract(place, (1.0, 0.25)) / (29.0, 9.75) for name, place in places.items()
    }
    for name, other in itertools.combinations(shares, 2):
        assert np.hypot(*(shares[name] - shares[other])) > 0.04, (name, other)
    assert min(places["6"][1], places["12"][1]) > 8.5  # no further than they must


@pytest.mark.parametrize(
    ("values", "within"),
    [
        (np.linspace(2.0, 9.0, 500), (2.0, 9.0)),
        (np.geomspace(1.0, 300.0, 500), (1.0, 300.0)),
        (np.linspace(-3.0, 3.0, 500), (-3.0, 3.0)),
    ],
)
def test_contours_are_at_round_numbers_inside_the_values(values, within):
    levels = round_levels(values)
    assert 2 <= len(levels) <= 9
    assert all(within[0] < level < within[1] for level in levels)
    assert all(float(f"{level:.2g}") == level for level in levels)


def test_without_values_there_are_no_contours():
    assert round_levels(np.array([])) == []
    assert round_levels(np.array([2.0, 2.0])) == []
