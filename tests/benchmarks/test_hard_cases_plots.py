"""The picture of the hard cases shows what the table says."""

import math

import pytest

from benchmarks.hard_cases import Judged, Mark
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.report.hard_cases_plots import _FILLS, cell_text, stability


def test_every_run_has_a_cell_in_the_colour_of_its_mark(judged):
    figure = stability(judged, {"base_100_0": "a hard base", "overturning": "tilt through 90°"})
    (axes,) = figure.axes
    of_methods = [each for each in judged if each.method in METHODS]
    assert len(judged) > len(of_methods)  # the batch engine has no column
    for patch, each in zip(axes.patches, of_methods, strict=True):
        expected = tuple(int(_FILLS[each.mark][i : i + 2], 16) / 255 for i in (1, 3, 5))
        assert patch.get_facecolor()[:3] == pytest.approx(expected)
        assert patch.get_x() == list(METHODS).index(each.method)
    assert [label.get_text() for label in axes.get_yticklabels()] == [
        "a hard base", "tilt through 90°",
    ]  # fmt: skip
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {
        mark.value for mark in Mark
    }


@pytest.mark.parametrize(
    ("verdict", "error", "text"),
    [
        (Verdict.RIGHT_OUTCOME, 3e-9, "−9"),
        (Verdict.RIGHT_OUTCOME, 0.0, "−16"),
        (Verdict.RIGHT_OUTCOME, 20.0, "1"),
        (Verdict.RIGHT_OUTCOME, math.nan, "·"),
        (Verdict.WRONG_OUTCOME, math.nan, "W"),
        (Verdict.TOO_MANY_EVALUATIONS, math.nan, "N"),
        (Verdict.FAILED, math.nan, "F"),
    ],
)
def test_a_cell_tells_the_error_or_what_went_wrong(verdict, error, text):
    each = Judged("a", "rk4_fixed", "aligned", verdict, Mark.STABLE, error, 0.0, 1, 1.0)
    assert cell_text(each) == text
