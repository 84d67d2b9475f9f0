"""Fig. 5, and what the figures of all datasets have in common."""

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.runs.simulate import simulate
from model.sweeps.sweep import merge, run
from study import plots
from study.plans import sweep_of
from tests.vibralign.plots.drawn import NAN, named
from vibralign.plots.history import force_before, history, trajectory
from vibralign.plots.style import cell_edges

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


def test_the_panels_show_the_coordinates_and_the_force(course):
    panels = history(course).axes
    assert len(panels) == 4
    for axes, name in zip(panels, ("x", "y", "tilt", "contact_force"), strict=True):
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), course["time"])
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), course[name])


def test_alignment_is_marked_in_every_panel_and_the_drop_of_n_in_the_last(course):
    moment = float(course["tau_align"])
    panels = history(course).axes
    for axes in panels:
        (mark,) = named(axes.lines, "alignment")
        assert set(mark.get_xdata()) == {moment}
    (note,) = panels[-1].texts
    assert f"drops to 0 at $τ$ = {moment:.4g}" in note.get_text()
    x, before = note.xy
    assert x == moment
    # The moment stands twice in the dataset: with the force before the jump, and after it.
    jump = np.flatnonzero(np.isclose(course["time"], moment, rtol=0.0, atol=1e-9))
    force = course["contact_force"].values
    assert before == force[jump[0]] > 0.0
    assert np.all(force[jump[-1] :] == 0.0)


def test_the_drop_is_drawn_as_a_jump():
    time, force = np.array([0.0, 1.0, 2.0, 2.0, 3.0]), np.array([1.0, 2.0, 1.5, 0.0, 0.0])
    assert force_before(time, force, 2.0) == 1.5
    assert force_before(time, np.zeros(5), 2.0) == 0.0


def test_a_part_that_does_not_align_has_no_mark(course):
    stuck = course.copy()
    stuck["outcome"] = np.int8(Outcome.HORIZON_REACHED)
    stuck["tau_align"] = NAN
    panels = history(stuck).axes
    assert not any(named(axes.lines, "alignment") for axes in panels)
    assert not panels[-1].texts
    assert panels[0].get_title(loc="right") == "does not align (horizon reached)"


def test_a_trajectory_is_drawn_as_its_dataset_is(study, course):
    run = simulate(study.parameters("fig05"), study.settings.settings)
    for one, other in zip(trajectory(run).axes, history(course).axes, strict=True):
        for line, same in zip(one.lines, other.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), same.get_xydata())


# --- All of them --------------------------------------------------------------------------------


def test_a_dataset_of_no_known_kind_is_refused(family):
    family.attrs["kind"] = "pie"
    with pytest.raises(ValueError, match=r"'pie'.*history, curves, map"):
        plots.draw(family)


def test_drawing_leaves_the_settings_of_matplotlib_alone(family):
    before = dict(mpl.rcParams)
    plots.draw(family)
    assert dict(mpl.rcParams) == before


def test_edges_of_cells_lie_halfway():
    np.testing.assert_allclose(cell_edges(np.array([1.0, 2.0, 4.0])), [0.5, 1.5, 3.0, 5.0])
