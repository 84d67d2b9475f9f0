"""Curves: jumps, ends of the axes, and what no accepted picture of test_pictures.py shows."""

import numpy as np
import pytest

from model.events.outcomes import Outcome
from tests.vibralign.plots.drawn import NAN, curve_lines, grid, named
from vibralign.plots import style
from vibralign.plots.curves import curves, jumps
from vibralign.plots.style import FAILED_LABEL

# --- Jumps and axes -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("frequency", "expected"),
    [
        # A third of the period 2 π/ν is 2.09, and 0.52 where ν is four times as great.
        (1.0, [False, True, False, False, False, True]),
        (4.0, [True, True, False, False, False, True]),
        (0.0, [False] * 6),  # without vibration nothing has a period
    ],
)
def test_a_difference_of_more_than_a_third_of_a_period_is_a_jump(frequency, expected):
    durations = np.array([[2.0, 3.0, 9.0, 9.2, NAN, 5.0, 2.5]])
    made_up = grid("curves", "tilt_stiffness", "press_force", durations)
    assert jumps(made_up.assign_coords(frequency=frequency)).tolist() == [expected]


def test_jumps_are_judged_by_the_frequency_of_their_curve_or_point():
    durations = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]])
    of_curves = grid("curves", "frequency", "press_force", durations)
    of_curves["frequency"] = [1.0, 4.0]
    assert jumps(of_curves).tolist() == [[False, False], [True, True]]
    of_points = grid("curves", "press_force", "frequency", durations)
    of_points["frequency"] = [1.0, 1.5, 4.0]
    assert jumps(of_points).tolist() == [[False, True], [False, True]]


def legend_words(figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_a_curve_that_is_longer_than_the_axis_has_an_arrow_there():
    durations = np.full((2, 60), 2.0)
    durations[1, :2] = 30.0, 25.0
    figure = curves(grid("curves", "tilt_stiffness", "press_force", durations))
    axes, words = figure.axes[0], "longer than the axis, up to $τ$ = 30"
    assert words in legend_words(figure)
    (arrow,) = (each for each in axes.lines if each.get_label().startswith("_beyond"))
    assert arrow.get_xydata().tolist() == [[0.25, axes.get_ylim()[1]]]
    assert arrow.get_color() == curve_lines(axes)[1].get_color()


@pytest.mark.parametrize(
    ("long", "top"),
    [([3.9, 2.8], 3.9), ([4.1, 2.8], 2.8), ([30.0, 2.8, 3.1], 2.8), ([30.0], 2.0)],
)
def test_the_axis_of_durations_ends_where_the_usual_ones_fill_half_of_it(long, top):
    """Nearly all durations are 2."""
    durations = np.full((2, 60), 2.0)
    durations[1, : len(long)] = long
    axes = curves(grid("curves", "tilt_stiffness", "press_force", durations)).axes[0]
    assert axes.get_ylim() == pytest.approx((0.0, 1.05 * top))


def test_a_long_end_of_the_axis_on_which_nothing_aligns_is_cut_off():
    durations = np.full((2, 19), 2.0)  # every half from 0.25 to 9.25
    durations[:, 10:], durations[0, 9] = NAN, NAN
    axes = curves(grid("curves", "tilt_stiffness", "press_force", durations)).axes
    low, high = axes[0].get_xlim()
    assert (low, high) == pytest.approx((0.0 - 0.05, 4.75 + 0.225 + 0.05), abs=1e-3)
    assert axes[1].get_xlabel().endswith("(computed from 0.25 to 9.25)")
    durations[:, 10:17] = 2.0
    axes = curves(grid("curves", "tilt_stiffness", "press_force", durations)).axes
    assert axes[0].get_xlim()[1] > 9.5
    assert "computed" not in axes[1].get_xlabel()


def test_failed_runs_are_marked_as_such(family):
    family["outcome"][3, 2] = Outcome.FAILED
    figure = curves(family)
    (crosses,) = named(figure.axes[1].lines, FAILED_LABEL)
    assert crosses.get_xydata().tolist() == [[family["press_force"].values[2], 3.0]]


def test_a_family_that_never_aligns_is_drawn_too(family, tmp_path):
    family["tau_align"][:] = NAN
    style.write(curves(family), tmp_path / "never.pdf")
