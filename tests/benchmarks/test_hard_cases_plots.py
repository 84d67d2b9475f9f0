"""The pictures of the hard cases show what the table says."""

import math

import pytest

from benchmarks.hard_cases import Judged, Mark
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.report.hard_cases_plots import _FILLS, cell_text, error_over_stiffness, stability
from model.study.config import load_study, study_path


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


def test_errors_stand_over_the_stiffness_in_the_panel_of_their_damping():
    spec = load_study(study_path()).hard_cases
    judged = [
        Judged(
            name, method, "settled", Verdict.RIGHT_OUTCOME, Mark.STABLE,
            1e-9 * case.at["contact_stiffness"] * (1.0 + case.at["contact_damping"]), 0.0, 1, 1.0,
        )
        for name, case in spec.all_cases.items() if "contact_stiffness" in case.at
        for method in METHODS
    ]  # fmt: skip
    figure = error_over_stiffness(judged, spec)
    assert len(figure.axes) == len(spec.base.damping)
    for axes, damping in zip(figure.axes, spec.base.damping, strict=True):
        line = axes.get_lines()[0]
        assert list(line.get_xdata()) == spec.base.stiffness
        assert list(line.get_ydata()) == pytest.approx(
            [1e-9 * stiffness * (1.0 + damping) for stiffness in spec.base.stiffness]
        )
