"""The check of what is drawn: it is silent where it should be, and sees a plot that lies."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.figure import Figure

from model.show import artists, plots
from model.show.artists import disagreements
from model.show.curves import SENSITIVE_LABEL
from model.study.datasets import compute_chunk, history_dataset, merge_chunks
from model.study.sweeps import sweep_of


@pytest.fixture(scope="module")
def datasets(small_study) -> dict[str, xr.Dataset]:
    """One computed dataset of every kind, with points that do not align."""
    study = small_study(7, 5)
    found = {"history": history_dataset(sweep_of(study, "fig05"), "t", "s")}
    for kind, name in {"curves": "fig06", "map": "fig13"}.items():
        sweep = sweep_of(study, name)
        found[kind] = merge_chunks(sweep, "t", "s", [compute_chunk(sweep, 0, 1)])
        assert np.isnan(found[kind]["tau_align"]).any()
        assert np.isfinite(found[kind]["tau_align"]).any()
    return found


@pytest.mark.parametrize("kind", ["history", "curves", "map"])
def test_what_the_study_draws_is_what_it_holds(datasets, kind: str) -> None:
    dataset = datasets[kind].copy(deep=True)
    assert disagreements(dataset) == []
    if kind == "curves":
        dataset["sensitive"][:, :] = 1
        assert disagreements(dataset) == []


def shift_first_line(figure: Figure) -> None:
    line = figure.axes[0].lines[0]
    line.set_ydata(np.asarray(line.get_ydata()) * 1.001)


def stretch_first_line(figure: Figure) -> None:
    line = figure.axes[0].lines[0]
    line.set_xdata(np.asarray(line.get_xdata()) + 0.01)


def swap_names(figure: Figure) -> None:
    first, second = figure.axes[0].lines[:2]
    names = first.get_label(), second.get_label()
    first.set_label(names[1])
    second.set_label(names[0])


def drop_a_curve(figure: Figure) -> None:
    figure.axes[0].lines[0].remove()


def empty_strip(figure: Figure) -> None:
    for axes in figure.axes[1:]:
        for each in axes.collections:
            if isinstance(each, PolyCollection):
                each.set_verts([])


def forget_sensitive(figure: Figure) -> None:
    for line in list(figure.axes[0].lines):
        if line.get_label() == SENSITIVE_LABEL:
            line.remove()


def recolour(figure: Figure) -> None:
    (mesh,) = (each for each in figure.axes[0].collections if isinstance(each, QuadMesh))
    mesh.set_array(mesh.get_array() * 1.001)


def unhatch(figure: Figure) -> None:
    for patch in list(figure.axes[0].patches):
        patch.remove()


def move_the_mark(figure: Figure) -> None:
    for line in figure.axes[0].lines:
        if line.get_label() == "alignment":
            line.set_xdata([0.0, 0.0])


@pytest.mark.parametrize(
    ("kind", "lie"),
    [
        ("history", shift_first_line),
        ("history", stretch_first_line),
        ("history", move_the_mark),
        ("curves", shift_first_line),
        ("curves", stretch_first_line),
        ("curves", swap_names),
        ("curves", drop_a_curve),
        ("curves", empty_strip),
        ("curves", forget_sensitive),
        ("map", recolour),
        ("map", unhatch),
    ],
)
def test_a_plot_that_lies_is_seen(
    datasets, monkeypatch, kind: str, lie: Callable[[Figure], None]
) -> None:
    dataset = datasets[kind].copy(deep=True)
    if kind == "curves":
        dataset["sensitive"][:, :] = 1

    def lying(given: xr.Dataset) -> Figure:
        figure = plots.draw(given)
        lie(figure)
        return figure

    monkeypatch.setattr(artists, "draw", lying)
    assert disagreements(dataset) != []


def test_a_dataset_of_an_unknown_kind_is_refused() -> None:
    with pytest.raises(ValueError, match="kind = 'pie'"):
        disagreements(xr.Dataset(attrs={"kind": "pie"}))
