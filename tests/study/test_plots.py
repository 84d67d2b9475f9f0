"""Fig. 5, and what the figures of all datasets have in common."""

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.sweeps.sweep import merge, run
from study import plots
from study.plans import sweep_of
from tests.vibralign.plots.drawn import NAN, named
from vibralign.plots.history import history

# --- Fig. 5 -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def study(small_study):
    return small_study(points=5, cells=4)


def dataset_of(study, name: str) -> xr.Dataset:
    sweep = sweep_of(study, name)
    return merge(sweep, "title", [run(sweep)])


@pytest.fixture(scope="module")
def course(study) -> xr.Dataset:
    return dataset_of(study, "fig05")


def test_a_part_that_does_not_align_has_no_mark(course):
    stuck = course.copy()
    stuck["outcome"] = np.int8(Outcome.HORIZON_REACHED)
    stuck["tau_align"] = NAN
    panels = history(stuck).axes
    assert not any(named(axes.lines, "alignment") for axes in panels)
    assert not panels[-1].texts
    assert panels[0].get_title(loc="right") == "does not align (horizon reached)"


# --- All of them --------------------------------------------------------------------------------


def test_a_dataset_of_no_known_kind_is_refused(family):
    family.attrs["kind"] = "pie"
    with pytest.raises(ValueError, match=r"'pie'.*history, curves, map"):
        plots.draw(family)


def test_drawing_leaves_the_settings_of_matplotlib_alone(family):
    before = dict(mpl.rcParams)
    plots.draw(family)
    assert dict(mpl.rcParams) == before
