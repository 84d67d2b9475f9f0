"""Comparison of a figure with its dataset: its artists are read back."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch

from model.show.axes import NOT_ALIGNED
from model.show.curves import SENSITIVE_LABEL
from model.show.plots import draw

if TYPE_CHECKING:
    import xarray as xr


def disagreements(dataset: "xr.Dataset") -> list[str]:
    """Return the differences between a dataset and what its figure draws.

    Raises:
        ValueError: a dataset of no known kind.
    """
    figure = draw(dataset)
    check = {"history": _history, "curves": _curves, "map": _map}[str(dataset.attrs["kind"])]
    return list(check(dataset, figure))


def _same(drawn: object, held: object) -> bool:
    return np.array_equal(
        np.asarray(drawn, dtype=float), np.asarray(held, dtype=float), equal_nan=True
    )


def _labelled(axes: Axes, label: str) -> list[Line2D]:
    return [line for line in axes.lines if line.get_label() == label]


def _history(dataset: "xr.Dataset", figure: Figure) -> Iterator[str]:
    panels = {"x": "x", "y": "y", "φ": "tilt", "n": "contact_force"}
    for axes, (label, name) in zip(figure.axes, panels.items(), strict=False):
        lines = _labelled(axes, label)
        if len(lines) != 1:
            yield f"panel {label}: {len(lines)} curves, must be 1"
        elif not _same(lines[0].get_xdata(), dataset["time"]):
            yield f"panel {label}: another time than the dataset's"
        elif not _same(lines[0].get_ydata(), dataset[name]):
            yield f"panel {label}: not the dataset's {name}"
    if not np.isnan(dataset["tau_align"].item()):
        marks = _labelled(figure.axes[0], "alignment")
        if not marks or not _same(marks[0].get_xdata(), [dataset["tau_align"].item()] * 2):
            yield "the moment of alignment is not marked where the dataset has it"


def _curves(dataset: "xr.Dataset", figure: Figure) -> Iterator[str]:
    family, swept = (dataset[name] for name in dataset["tau_align"].dims)
    durations = dataset["tau_align"].values
    axes = figure.axes[0]
    curves = [line for line in axes.lines if " = " in str(line.get_label())
              and not str(line.get_label()).startswith("_")]  # fmt: skip
    if len(curves) != family.size:
        yield f"{len(curves)} curves for {family.size} values of {family.name}"
        return
    for line, value, row in zip(curves, family.values, durations, strict=True):
        if not str(line.get_label()).endswith(f"= {value:g}"):
            yield f"curve {line.get_label()} stands where {family.name} = {value:g} belongs"
        if not _same(line.get_xdata(), swept) or not _same(line.get_ydata(), row):
            yield f"curve {line.get_label()} is not the dataset's"
    sensitive = (dataset["sensitive"].values == 1) & ~np.isnan(durations)
    marked = sum(len(np.atleast_1d(line.get_xdata())) for line in _labelled(axes, SENSITIVE_LABEL))
    if marked != sensitive.sum():
        yield f"{marked} sensitive points marked, the dataset has {sensitive.sum()}"
    yield from _strip(figure, swept.values, np.isnan(durations))


def _strip(figure: Figure, swept: np.ndarray, gaps: np.ndarray) -> Iterator[str]:
    """Yield the curves whose bars below do not cover exactly their gaps."""
    bars = [
        each
        for axes in figure.axes[1:]
        for each in axes.collections
        if isinstance(each, PolyCollection) and NOT_ALIGNED in str(each.get_label())
    ]
    if not gaps.any():
        return
    for row, mask in enumerate(gaps):
        spans = [path.get_extents() for path in bars[row].get_paths()] if row < len(bars) else []
        covered = np.zeros(mask.shape, dtype=bool)
        for span in spans:
            covered |= (swept >= span.x0) & (swept <= span.x1)
        if not np.array_equal(covered, mask):
            yield f"curve {row}: the strip does not show where it has gaps"


def _map(dataset: "xr.Dataset", figure: Figure) -> Iterator[str]:
    y, x = (dataset[name].values for name in dataset["tau_align"].dims)
    durations = dataset["tau_align"].values
    gaps = np.isnan(durations)
    axes = figure.axes[0]
    meshes = [each for each in axes.collections if isinstance(each, QuadMesh)]
    if gaps.all() != (not meshes):
        yield f"{len(meshes)} areas in colour"
    for mesh in meshes:
        drawn: np.ndarray = np.ma.filled(np.ma.asarray(mesh.get_array(), dtype=float), np.nan)
        if not _same(drawn.reshape(durations.shape), durations):
            yield "the colours are not the dataset's durations"
    hatched = [each for each in axes.patches if each.get_label() == NOT_ALIGNED]
    if len(hatched) != 1 or not isinstance(hatched[0], PathPatch):
        yield "no area is hatched"
        return
    centres = np.column_stack([each.ravel() for each in np.meshgrid(x, y)])
    inside = hatched[0].get_path().contains_points(centres).reshape(gaps.shape)
    if not np.array_equal(inside, gaps):
        yield f"{int((inside != gaps).sum())} cells hatched otherwise than the dataset has them"
