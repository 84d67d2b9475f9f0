"""Figs. 6-12: curves show the values of their datasets, and gaps where nothing aligns."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.path import Path as Outline

from model.events.outcomes import Outcome
from tests.vibralign.plots.drawn import DURATIONS, NAN, curve_lines, followed, grid, named
from vibralign.plots import style
from vibralign.plots.curves import SENSITIVE_LABEL, curves, jumps
from vibralign.plots.style import FAILED_LABEL, NOT_ALIGNED, NOT_INSERTED


def segments(line) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the straight pieces of a line that a renderer gets, without NaN."""
    pieces, previous = [], None
    for vertices, code in line.get_path().iter_segments(remove_nans=True, simplify=False):
        if code == Outline.LINETO:
            pieces.append((previous, vertices))
        previous = vertices
    return pieces


def test_a_curve_holds_the_row_of_its_family_value_with_its_gaps(family):
    axes = curves(family).axes[0]
    for line, row in zip(curve_lines(axes), DURATIONS, strict=True):
        np.testing.assert_array_equal(line.get_ydata(), row)
        np.testing.assert_array_equal(line.get_xdata(), family["press_force"])


def test_no_piece_of_a_line_crosses_a_gap(family):
    swept = family["press_force"].values.tolist()
    lines = [each for each in curves(family).axes[0].lines if each.get_linestyle() != "None"]
    pieces = [piece for line in lines for piece in segments(line)]
    assert all(swept.index(end[0]) - swept.index(start[0]) == 1 for start, end in pieces)
    aligned = ~np.isnan(DURATIONS)
    assert len(pieces) == (aligned[:, 1:] & aligned[:, :-1]).sum()


def test_a_point_alone_between_gaps_is_drawn_as_a_dot(family):
    figure = curves(family)
    dots = [line for line in figure.axes[0].lines if line.get_label().startswith("_alone")]
    found = sorted((x, y) for line in dots for x, y in line.get_xydata().tolist())
    swept = family["press_force"].values
    # By eye from DURATIONS: row 1 has two points alone, row 2 its first.
    assert found == sorted([(swept[2], 6.0), (swept[8], 4.0), (swept[0], 9.0)])
    assert all(line.get_marker() not in ("", "None") for line in dots)


def bars(strip, label: str) -> list[PolyCollection]:
    return [each for each in strip.collections if each.get_label().startswith(f"_{label}")]


def covered(collection: PolyCollection, points: list[tuple[float, float]]) -> np.ndarray:
    return np.any([path.contains_points(points) for path in collection.get_paths()], axis=0)


def test_the_strip_says_exactly_where_each_curve_does_not_align(family):
    full = bars(curves(family).axes[1], NOT_ALIGNED)
    assert len(full) == len(DURATIONS)
    for row, (collection, durations) in enumerate(zip(full, DURATIONS, strict=True)):
        points = [(x, row) for x in family["press_force"].values]
        expected = np.isnan(durations)
        np.testing.assert_array_equal(covered(collection, points) & expected.any(), expected)
        assert collection.get_facecolor().size


def test_the_strip_has_open_bars_where_parts_align_and_do_not_go_in(family):
    opened = bars(curves(followed(family, [(0, 3), (2, 4)])).axes[1], NOT_INSERTED)
    x = family["press_force"].values
    found = [[*covered(each, [(at, row) for at in x]).nonzero()[0]] if each.get_paths() else []
             for row, each in enumerate(opened)]  # fmt: skip
    assert found == [[3], [], [4], []]
    assert not any(each.get_facecolor().size for each in opened)
    assert "aligns, but does not go in" in legend_words(curves(followed(family, [(0, 3)])))
    assert NOT_INSERTED not in legend_words(curves(followed(family, [])))


def test_sensitive_points_are_circled_and_explained(family):
    family["sensitive"][0, 3] = 1
    family["sensitive"][1, 0] = 1  # does not align: there is nothing to circle
    figure = curves(family)
    (circles,) = named(figure.axes[0].lines, SENSITIVE_LABEL)
    assert circles.get_xydata().tolist() == [[family["press_force"].values[3], 3.8]]


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


def test_no_line_crosses_a_jump_and_a_point_between_two_is_a_dot():
    durations = np.array([[2.0, 2.1, 9.0, 9.1, 20.0, 3.0, 3.1]])
    figure = curves(grid("curves", "tilt_stiffness", "press_force", durations))
    (line,) = curve_lines(figure.axes[0])
    heights = [(start[1], end[1]) for start, end in segments(line)]
    assert heights == [(2.0, 2.1), (9.0, 9.1), (3.0, 3.1)]
    (dot,) = (each for each in figure.axes[0].lines if each.get_label().startswith("_alone"))
    assert dot.get_ydata().tolist() == [20.0]


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


@pytest.mark.parametrize("durations", [[2.0, 5.0, 6.0], [5.0, 5.5, 6.0], [NAN] * 3])
def test_the_axis_of_durations_begins_at_0(durations):
    figure = curves(grid("curves", "tilt_stiffness", "press_force", np.array([durations])))
    assert figure.axes[0].get_ylim()[0] == 0.0


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
    figure = curves(family)
    assert all(not segments(line) for line in figure.axes[0].lines)
    style.write(figure, tmp_path / "never.pdf")
