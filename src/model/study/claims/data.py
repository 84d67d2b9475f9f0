"""Views of datasets for the claims: points, curves, maps and trajectories, and ranges of them.

A sensitive point ends differently at another tolerance. Points and curves leave such points out, so
that no claim depends on them. NaN is an unknown value.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS
from model.study.config.figures import CURVES

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]
Where = Mapping[str, str | float]  # a range for ``between``, by column
Read = TypeVar("Read")

NAN = float("nan")
# As integers: to compare an array with a member of the enumeration takes five times as long.
_ALIGNED, _SETTLED = int(Outcome.ALIGNED), int(Outcome.SETTLED)
_MOMENTS = 200  # at which a trajectory is sampled


class MissingDataError(LookupError):
    """A dataset that a claim needs, or a value in it, is missing."""


class Range(NamedTuple):
    """Numbers from ``low`` to ``high``, both included."""

    low: float
    high: float


@cache
def between(text: str | float) -> Range:
    """Return the range that a text states: any, 2, 5 to 7, < 2, <= 2, > 2 or >= 2.

    Raises:
        ValueError: a text of another form.
    """
    if text == "any":
        return Range(-math.inf, math.inf)
    number = r"(-?[\d.]+|inf)"
    if match := re.fullmatch(f"(?:{number} to )?{number}", str(text)):
        high = float(match[2])
        return Range(float(match[1] or high), high)
    match = re.fullmatch(f"([<>])(=?) {number}", str(text))
    if not match:
        raise ValueError(f"{text!r} is no range: write any, 2, 5 to 7, < 2, <= 2, > 2 or >= 2")
    end, is_upper = float(match[3]), match[1] == "<"
    if not match[2]:
        end = float(np.nextafter(end, -math.inf if is_upper else math.inf))
    return Range(-math.inf, end) if is_upper else Range(end, math.inf)


@dataclass(frozen=True)
class Points:
    """Points of a dataset.

    Attributes:
        columns: of shape (n,) each: variables of the dataset, varied parameters, ``aligned`` and
            ``settled`` (from the outcome), and ``tau`` (alignment time, NaN without alignment).
    """

    columns: Columns

    def column(self, name: str, aligned: bool = False) -> Array:
        """Return a column of shape (n,); with ``aligned``, NaN for points that do not align.

        Raises:
            MissingDataError: there is no such column.
        """
        if name not in self.columns:
            raise MissingDataError(f"the dataset has no {name}")
        values = np.asarray(self.columns[name])
        return np.where(self.aligned, values, NAN) if aligned else values

    @property
    def aligned(self) -> Flags:
        """Flags of the points that align."""
        return np.asarray(self.columns["aligned"])

    @property
    def tau(self) -> Array:
        """Alignment times, NaN where a point does not align."""
        return np.asarray(self.columns["tau"])

    def at(self, where: Where) -> Flags:
        """Return flags of the points that lie in the ranges of ``where``."""
        inside: Flags = np.ones(self.aligned.size, dtype=np.bool_)
        for name, text in where.items():
            low, high = self.range_of(text)
            values = self.column(name)
            inside &= (values >= low) & (values <= high)
        return inside

    def range_of(self, text: str | float) -> Range:
        """Return the range that a text means; see ``between``."""
        return between(text)

    def share(self, of: Where, among: Where | None = None) -> float:
        """Return the share of the points in ``among`` that also lie in ``of``, NaN without any."""
        inside = self.at(of)[self.at(among)] if among else self.at(of)
        return int(np.count_nonzero(inside)) / inside.size if inside.size else NAN


@dataclass(frozen=True)
class Curve(Points):
    """Points of one curve, ordered by the swept parameter, the column ``x``.

    Attributes:
        symbol: symbol of the parameter that differs between the curves of the figure.
        value: value of that parameter.
    """

    symbol: str
    value: float

    @property
    def x(self) -> Array:
        """Values of the swept parameter."""
        return np.asarray(self.columns["x"])

    @cached_property
    def name(self) -> str:
        """The curve in words, such as "k_φ = 5"."""
        return f"{self.symbol} = {self.value:g}"

    def range_of(self, text: str | float) -> Range:
        """Return the range that a text means; also the "first tenth" or "last tenth" of x."""
        if text not in ("first tenth", "last tenth"):
            return between(text)
        if not self.x.size:
            return Range(NAN, NAN)
        tenth = 0.1 * float(np.ptp(self.x))
        if text == "first tenth":
            return Range(-math.inf, self.x[0] + tenth)
        return Range(self.x[-1] - tenth, math.inf)

    def within(self, text: str | float) -> "Curve":
        """Return the part of the curve where ``x`` is in a range."""
        return self if text == "any" else self.only(self.at({"x": text}))

    def only(self, kept: Flags) -> "Curve":
        """Return the curve of the points whose flag in ``kept``, shape (n,), is set."""
        columns = {name: values[kept] for name, values in self.columns.items()}
        return Curve(columns, self.symbol, self.value)

    @cached_property
    def halves(self) -> "tuple[Curve, Curve]":
        """The aligning points in the lower and upper half of their range of x.

        A point in the middle belongs to both.
        """
        points = self.only(self.aligned)
        if not points.x.size:
            return points, points
        middle = 0.5 * (points.x[0] + points.x[-1])
        return points.only(points.x <= middle), points.only(points.x >= middle)


@dataclass(frozen=True)
class MapGrid:
    """Cells of a map.

    Attributes:
        x, y: values of the varied parameters, shape (x,) and (y,).
        aligned: True where the part aligns, shape (y, x); to be used where ``regular`` only.
        regular: True for cells that are not sensitive, shape (y, x).
        tau: alignment time, NaN where the part does not align, shape (y, x).
    """

    x: Array
    y: Array
    aligned: Flags
    regular: Flags
    tau: Array

    def safe(self, reach: float) -> Flags:
        """Return flags of the cells around which all cells align, shape (y, x).

        ``reach`` is the distance along both axes, as a share of their lengths.
        """
        cells = [2 * max(1, round(reach * (size - 1))) + 1 for size in self.aligned.shape]
        lowest = ndimage.minimum_filter((self.aligned | ~self.regular).astype(np.int8), cells)
        return np.asarray(lowest == 1)


@dataclass(frozen=True)
class SampledRun:
    """A trajectory until it aligns or ends, sampled at n equidistant moments.

    Attributes:
        aligned: True if the part aligns.
        x, y, tilt: moving means over a period of the excitation, of at most n values.
        force: contact force, shape (n,).
        fall: time from the last moment with at least half the mean contact force until the end, as
            a share of the duration.
    """

    aligned: bool
    x: Array
    y: Array
    tilt: Array
    force: Array
    fall: float


class Data:
    """Views of the datasets by name; a view is made when it is first asked for, and kept.

    Args:
        datasets: by name: of figures ("fig06"), and of runs made for the claims ("pressed").
    """

    def __init__(self, datasets: "Mapping[str, xr.Dataset]") -> None:
        self.datasets = datasets
        self._views: dict[tuple[str, str], object] = {}

    def dataset(self, name: str) -> "xr.Dataset":
        """Return a dataset.

        Raises:
            MissingDataError: there is none of this name. The views below raise it as well.
        """
        if name not in self.datasets:
            raise MissingDataError(f"there is no dataset {name}")
        return self.datasets[name]

    def _view(self, name: str, make: "Callable[[xr.Dataset], Read]") -> Read:
        key = (name, make.__name__)
        if key not in self._views:
            self._views[key] = make(self.dataset(name))
        return self._views[key]  # type: ignore[return-value]

    def curves(self, name: str, at: str | float | list[float] = "any") -> tuple[Curve, ...]:
        """Return the curves of a figure in a range of the family's parameter, in rising order.

        ``at`` may also be a list of values, one for each curve.

        Raises:
            MissingDataError: there is no curve in the range, or of a value in the list.
        """
        if isinstance(at, list):
            return tuple(curve for value in at for curve in self.curves(name, value))
        low, high = between(at)
        curves = tuple(c for c in self._view(name, _curves) if low <= c.value <= high)
        if not curves:
            raise MissingDataError(f"{name} has no curve between {low:g} and {high:g}")
        return curves

    def map_grid(self, name: str) -> MapGrid:
        """Return the map of a figure."""
        return self._view(name, _map_grid)

    def sampled_run(self, name: str) -> SampledRun:
        """Return the trajectory of a figure."""
        return self._view(name, _sampled_run)

    def points(self, name: str) -> Points:
        """Return the points of a dataset."""
        return self._view(name, _points)

    def drawn(self, name: str) -> tuple[Points, ...]:
        """Return the curves of a figure that has curves; all points of another dataset as one."""
        return self.curves(name) if name in CURVES else (self.points(name),)

    def held(self, name: str, parameter: str) -> float:
        """Return the value at which a figure holds a parameter."""
        return float(_raw(self.dataset(name), parameter))


def _raw(dataset: "xr.Dataset", name: str) -> NDArray[np.generic]:
    return np.asarray(dataset.variables[name].values)


def _dimensions(dataset: "xr.Dataset") -> tuple[str, ...]:
    return tuple(map(str, dataset.variables["tau_align"].dims))


def _columns(dataset: "xr.Dataset") -> dict[str, NDArray[np.generic]]:
    """Return the columns of ``Points``, in the shape of the dataset."""
    names = _dimensions(dataset)
    columns = {
        str(name): _raw(dataset, str(name))
        for name, variable in dataset.variables.items()
        if variable.dims == names and name not in names
    }
    aligned, settled = (columns["outcome"] == end for end in (_ALIGNED, _SETTLED))
    tau = np.where(aligned, columns["tau_align"], NAN)
    return {**columns, "aligned": aligned, "settled": settled, "tau": tau}


def _points(dataset: "xr.Dataset") -> Points:
    columns = _columns(dataset)
    names = _dimensions(dataset)
    axes = np.meshgrid(*(_raw(dataset, name) for name in names), indexing="ij") if names else []
    columns |= dict(zip(names, axes, strict=True))
    kept = columns["sensitive"] == 0
    return Points({name: np.atleast_1d(each[kept]) for name, each in columns.items()})


def _curves(dataset: "xr.Dataset") -> tuple[Curve, ...]:
    family, swept = _dimensions(dataset)
    x, values = (_raw(dataset, name).astype(np.float64) for name in (swept, family))
    columns, symbol = _columns(dataset), FIELDS[family].symbol
    order = np.argsort(x, kind="stable")
    curves = []
    for i in np.argsort(values, kind="stable"):
        kept = order[columns["sensitive"][i, order] == 0]
        along = {name: each[i, kept] for name, each in columns.items()}
        curves.append(Curve({**along, "x": x[kept]}, symbol, float(values[i])))
    return tuple(curves)


def _map_grid(dataset: "xr.Dataset") -> MapGrid:
    y, x = _dimensions(dataset)
    aligned = _raw(dataset, "outcome") == _ALIGNED
    return MapGrid(
        x=_raw(dataset, x).astype(np.float64),
        y=_raw(dataset, y).astype(np.float64),
        aligned=aligned,
        regular=_raw(dataset, "sensitive") == 0,
        tau=np.where(aligned, _raw(dataset, "tau_align"), NAN),
    )


def _sampled_run(dataset: "xr.Dataset") -> SampledRun:
    time = _raw(dataset, "time").astype(np.float64)
    aligned = int(_raw(dataset, "outcome")) == _ALIGNED
    end = float(_raw(dataset, "tau_align")) if aligned else float(time[-1])
    if end == 0.0:
        raise MissingDataError("the run of the history did not begin")
    moments = np.linspace(0.0, end, _MOMENTS)
    x, y, tilt, force = (
        np.interp(moments, time, _raw(dataset, name).astype(np.float64))
        for name in ("x", "y", "tilt", "contact_force")
    )
    # Where the force jumps a time occurs twice; at the end the value before the jump counts.
    until = time <= end
    pressing = _raw(dataset, "contact_force").astype(np.float64)[until]
    strong = time[until][pressing >= 0.5 * max(float(force.mean()), 1e-300)]
    frequency = float(_raw(dataset, "frequency"))
    period = 2.0 * np.pi / frequency if frequency > 0.0 else 0.0
    width = round(period / end * (_MOMENTS - 1))
    return SampledRun(
        aligned=aligned,
        x=_moving_mean(x, width),
        y=_moving_mean(y, width),
        tilt=_moving_mean(tilt, width),
        force=force,
        fall=float((end - strong[-1]) / end) if strong.size else 1.0,
    )


def _moving_mean(values: Array, width: int) -> Array:
    """Return means over ``width`` moments.

    Returns ``values`` unchanged where the width is one moment or more than half of them.
    """
    if width < 2 or 2 * width > values.size:
        return values
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")
