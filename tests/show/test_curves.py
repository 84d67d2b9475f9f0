"""Figs. 6-12: curves show the values of their datasets, and a gap where nothing aligns."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.path import Path as Outline

from model.events.outcomes import Outcome
from model.show import style
from model.show.curves import SENSITIVE_LABEL, curves, draw_runs
from model.show.style import FAILED_LABEL, NOT_INSERTED
from tests.show.drawn import DURATIONS, NAN, curve_lines, followed, named
from tests.study.claims_data import falling, within
from tests.study.claims_data import runs as made_up


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


def test_the_strip_says_exactly_where_each_curve_does_not_align(family):
    strip = curves(family).axes[1]
    bars = [each for each in strip.collections if isinstance(each, PolyCollection)]
    assert len(bars) == len(DURATIONS)
    for row, (collection, durations) in enumerate(zip(bars, DURATIONS, strict=True)):
        points = [(x, row) for x in family["press_force"].values]
        covered = np.zeros(len(points), dtype=bool)
        for path in collection.get_paths():
            covered |= path.contains_points(points)
        np.testing.assert_array_equal(covered, np.isnan(durations))


def test_sensitive_points_are_circled_and_explained(family):
    family["sensitive"][0, 3] = 1
    family["sensitive"][1, 0] = 1  # does not align: there is nothing to circle
    figure = curves(family)
    (circles,) = named(figure.axes[0].lines, SENSITIVE_LABEL)
    assert circles.get_xydata().tolist() == [[family["press_force"].values[3], 3.8]]


def test_points_that_align_and_do_not_go_in_are_crossed(family):
    figure = curves(followed(family, [(0, 3), (2, 4)]))
    (crosses,) = named(figure.axes[0].lines, NOT_INSERTED)
    x = family["press_force"].values
    assert crosses.get_xydata().tolist() == [[x[3], 3.8], [x[4], 6.9]]
    assert not named(curves(followed(family, [])).axes[0].lines, NOT_INSERTED)


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


# --- Runs made for the claims alone -------------------------------------------------------------

RUNS = {"centred": falling, "pressed": within(2.0, 3.0), "misaligned": falling,
         "displaced": within(5.0, 30.0), "rubbing": within(0.0, 0.5)}  # fmt: skip


@pytest.fixture(scope="module")
def runs():
    titled = {
        name: made_up(name, tau)[name].assign_attrs(title=f"Title of {name}")
        for name, tau in RUNS.items()
    }
    return draw_runs(*titled.values()), titled


def test_a_panel_shows_what_the_ledger_looks_at(runs) -> None:
    drawn, datasets = runs
    looked_at = ("excursion", "tilt_end", "tau_align", "way", "tau_align")
    for axes, name, variable in zip(drawn.axes, RUNS, looked_at, strict=False):
        values = datasets[name][variable].values[0]
        assert np.array_equal(axes.lines[0].get_ydata(), values, equal_nan=True)


def test_runs_that_align_are_crossed_where_no_duration_is_shown(runs) -> None:
    drawn, datasets = runs
    crosses = [line for line in drawn.axes[1].lines if line.get_marker() == "x"]
    aligned = np.isfinite(datasets["pressed"]["tau_align"].values)
    assert sum(len(line.get_xdata()) for line in crosses) == aligned.sum()
    assert not [line for line in drawn.axes[4].lines if line.get_marker() == "x"]
