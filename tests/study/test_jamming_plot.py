"""Jamming: the figure marks every part that falls in, and draws the limits of each clearance."""

import numpy as np
import pytest

from model.events.outcomes import Outcome
from study.jamming import entered
from study.jamming_plot import DIAGRAM, TWO_POINTS, WEDGED, draw_jamming
from tests.vibralign.plots.drawn import jamming_data, named


@pytest.fixture(scope="module")
def figure():
    return draw_jamming(jamming_data())


def test_every_part_that_falls_in_is_marked_by_its_end(figure) -> None:
    data = jamming_data()
    for place, axes in enumerate(figure.axes[:2]):
        outcome = data["outcome"].values[place]
        for label, end in (("inserted", Outcome.INSERTED), ("jammed", Outcome.JAMMED),
                           ("climbed out", Outcome.CLIMBED_OUT)):  # fmt: skip
            marks = [tuple(xy) for line in named(axes.lines, label) for xy in line.get_xydata()]
            tilt, friction = data["tilt_at_alignment"].values[place], data["friction"].values
            expected = [(tilt[i, j], friction[j]) for i, j in np.argwhere(outcome == end)]
            assert sorted(marks) == sorted(expected)


def test_lines_are_the_closed_forms_of_the_panels_clearance(figure) -> None:
    for axes, clearance in zip(figure.axes[:2], (0.03, 0.09), strict=True):
        assert axes.get_title(loc="left") == f"δ = {clearance}"
        (limit,) = named(axes.lines, WEDGED)
        tilt, friction = limit.get_xdata(), limit.get_ydata()
        # The two contact points are h apart along the side of the part, and d across it.
        np.testing.assert_allclose(np.cos(tilt) + friction * np.sin(tilt), 1.0 + clearance)
        (deep,) = named(axes.lines, TWO_POINTS)
        at, depth = deep.get_xdata()[0], 0.8 / 1.8
        assert np.cos(at) + depth * np.sin(at) == pytest.approx(1.0 + clearance)


def test_the_same_parts_are_in_the_jamming_diagram_of_their_clearance(figure) -> None:
    data = jamming_data()
    for place, axes in enumerate(figure.axes[2:]):
        marks = [xy for line in axes.lines if line.get_linestyle() == "None"
                 for xy in line.get_xydata()]  # fmt: skip
        assert len(marks) == entered(data)[place].sum()
        (border,) = named(axes.lines, DIAGRAM)
        assert np.abs(border.get_xydata()).max(axis=1) == pytest.approx(1.0)
