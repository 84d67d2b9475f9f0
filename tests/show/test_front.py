"""The pictures of the front: every set at its numbers, the chosen one marked."""

import numpy as np

from model.show.front import budget_picture, front_picture
from model.study.config import Aims
from model.study.identification.committed import BudgetFront, FrontSet

AIMS = Aims(
    missing=13,
    beside=["M4b"],
    not_resting=0.08,
    not_resting_most=0.35,
    tilt=0.175,
    corners=0.97,
    aligned=0.2,
)


def test_the_front_shows_every_set_and_marks_the_device() -> None:
    sets = (
        FrontSet(True, False, 52, "N1 M4", 0.2, 0.6, 0.25, 0.9, 0.4),
        FrontSet(False, False, 49, "N1 M4", 0.3, 0.7, 0.3, 0.8, 0.4),
        FrontSet(True, True, 51, "N1 M4", 0.1, 0.4, 0.2, 0.95, 0.4),
    )
    figure = front_picture(sets, AIMS)
    left, right = figure.axes[:2]
    np.testing.assert_allclose(left.collections[0].get_offsets(), [[0.2, 52], [0.3, 49]])
    np.testing.assert_allclose(right.collections[0].get_offsets(), [[0.6, 52], [0.7, 49]])
    ringed, star = left.lines[:2]
    assert (list(ringed.get_xdata()), list(ringed.get_ydata())) == ([0.2], [52])
    assert (list(star.get_xdata()), list(star.get_ydata())) == ([0.1], [51])
    assert star.get_marker() == "*"


def test_the_budget_has_a_front_for_each_part_of_it() -> None:
    fronts = (
        BudgetFront(1000, 50, 0.3, 0.9, 0.3, 0.9, 0.4),
        BudgetFront(4000, 51, 0.2, 0.6, 0.2, 0.9, 0.4),
        BudgetFront(4000, 48, 0.1, 0.5, 0.2, 0.9, 0.4),
    )
    (axes,) = budget_picture(fronts, AIMS).axes
    first, second = axes.lines[:2]
    assert first.get_label() == "1000 candidates"
    assert list(second.get_xdata()) == [0.1, 0.2]
    assert list(second.get_ydata()) == [48, 51]
