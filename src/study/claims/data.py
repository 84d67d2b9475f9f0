"""Figures as arrays, which the checks of the ledger read.

A sensitive run ends differently at another tolerance: it belongs to no curve, and decides nothing.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


class MissingDataError(LookupError):
    """A dataset that an entry needs, or a value in it, is missing."""


@dataclass(frozen=True)
class Curve:
    """Runs along one curve of a figure, or one row of a map.

    Attributes:
        at: value of the parameter by which curves differ.
        x: swept parameter, shape (n,), rising.
        results: results of the runs by name, each of shape (n,).
    """

    at: float
    x: Array
    results: Mapping[str, NDArray[Any]]

    @cached_property
    def aligned(self) -> Flags:
        """Flags of the runs that align, shape (n,)."""
        return np.asarray(self.result("outcome") == Outcome.ALIGNED)

    @cached_property
    def tau(self) -> Array:
        """Alignment times, NaN where a part does not align, shape (n,)."""
        return np.where(self.aligned, self.result("tau_align"), np.nan)

    def result(self, name: str) -> NDArray[Any]:
        """Return a result of the runs, shape (n,).

        Raises:
            MissingDataError: the figure's dataset lacks it.
        """
        if name not in self.results:
            raise MissingDataError(f"the figure has no {name!r}")
        return self.results[name]

    def where(self, kept: Flags) -> "Curve":
        """Return the runs with a flag of shape (n,)."""
        return Curve(self.at, self.x[kept], {n: each[kept] for n, each in self.results.items()})


@dataclass(frozen=True)
class Figure:
    """Runs of one device over the grid of a figure, or the one run of a history.

    Attributes:
        name: name of the figure, such as "fig06".
        kind: "history", "curves" or "map".
        axes: swept parameters by name, slowest first: that by which curves or the rows of a map
            differ, shape (m,), and that along them, shape (n,); empty for a history.
        results: results of the runs by name, each of shape (m, n), or (1, 1) of a history;
            "sensitive" among them.
        held: parameters that the figure holds.
        course: time, coordinates and contact force of a history, each of shape (t,), until the
            corners of a part that aligns are inside; empty for others.
    """

    name: str
    kind: str
    axes: Mapping[str, Array]
    results: Mapping[str, NDArray[Any]]
    held: Mapping[str, float]
    course: Mapping[str, Array]

    @property
    def is_map(self) -> bool:
        """True for a plane of two swept parameters."""
        return self.kind == "map"

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        by, x = self.axes.values() or (np.zeros(1), np.zeros(1))
        return by, x

    @property
    def by(self) -> Array:
        """Values by which curves or rows differ, shape (m,)."""
        return self._ends[0]

    @property
    def x(self) -> Array:
        """Values along curves or rows, shape (n,)."""
        return self._ends[1]

    @cached_property
    def curves(self) -> list[Curve]:
        """Curves, or rows, by rising value."""
        kept = self.results["sensitive"] == 0
        return [
            Curve(
                float(self.by[row]),
                self.x[kept[row]],
                {name: each[row][kept[row]] for name, each in self.results.items()},
            )
            for row in np.argsort(self.by)
        ]

    @cached_property
    def whole(self) -> Curve:
        """All runs as one, with the parameters of each among its results."""
        kept = self.results["sensitive"] == 0
        shape = kept.shape
        grid = dict(zip(self.axes, np.meshgrid(*self._ends, indexing="ij"), strict=False))
        every = {**{n: np.full(shape, v) for n, v in self.held.items()}, **grid, **self.results}
        return Curve(np.nan, np.arange(float(kept.sum())), {n: v[kept] for n, v in every.items()})

    @cached_property
    def columns(self) -> list[Curve]:
        """Columns of a map, by rising value along its x axis."""
        turned = {name: each.T for name, each in self.results.items()}
        axes = dict(reversed([*self.axes.items()]))
        return Figure(self.name, self.kind, axes, turned, self.held, {}).curves

    @cached_property
    def cells(self) -> NDArray[np.int8]:
        """Cells of a map, shape (m, n): 1 if the part aligns, 0 if not, -1 if it is sensitive."""
        aligned = (self.results["outcome"] == Outcome.ALIGNED).astype(np.int8)
        return np.where(self.results["sensitive"] == 0, aligned, np.int8(-1))


Figures = Mapping[str, Figure]


def figure_of(dataset: "xr.Dataset") -> Figure:
    """Return the figure of a dataset of the study."""
    dims = dataset["outcome"].dims
    names = [str(name) for name, values in dataset.data_vars.items() if values.dims == dims]
    course: dict[str, Array] = {}
    if not dims:
        course = {
            str(name): values.values
            for name, values in dataset.variables.items()
            if values.dims == dataset["time"].dims
        }
    return Figure(
        name=str(dataset.attrs["figure"]),
        kind=str(dataset.attrs["kind"]),
        axes={str(name): dataset[name].values for name in dims},
        results={name: np.atleast_2d(dataset[name].values) for name in names},
        held={str(n): float(v) for n, v in dataset.coords.items() if v.ndim == 0},
        course=course,
    )
