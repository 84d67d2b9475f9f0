"""Read datasets as claims need them: points, curves, planes, courses, and ranges of them.

A sensitive point ends differently at another tolerance. Curves and points leave such points out,
neither aligned nor not, so that they decide nothing. NaN is an unknown value.
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
Where = Mapping[str, str | float]  # a range, as ``between`` reads it, for some columns
Read = TypeVar("Read")

NAN = float("nan")
# Comparing arrays with the enumeration takes five times as long.
_ALIGNED, _SETTLED = int(Outcome.ALIGNED), int(Outcome.SETTLED)
_MOMENTS = 200  # of a trajectory
_TENTH = 0.1  # of an axis


class MissingDataError(LookupError):
    """A dataset that a claim needs is missing, or a value in it."""


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
    if found := re.fullmatch(f"(?:{number} to )?{number}", str(text)):
        high = float(found[2])
        return Range(float(found[1] or high), high)
    found = re.fullmatch(f"([<>])(=?) {number}", str(text))
    if not found:
        raise ValueError(f"{text!r} is no range: write any, 2, 5 to 7, < 2, <= 2, > 2 or >= 2")
    end, is_upper = float(found[3]), found[1] == "<"
    if not found[2]:
        end = float(np.nextafter(end, -math.inf if is_upper else math.inf))
    return Range(-math.inf, end) if is_upper else Range(end, math.inf)


@dataclass(frozen=True)
class Points:
    """Points of a dataset by column, each of shape (n,).

    Columns are the dataset's variables, the parameters it varies, ``aligned`` and ``settled``
    (the outcome), and ``tau`` (the alignment time, NaN where a point does not align).
    """

    columns: Columns

    def column(self, name: str, aligned: bool = False) -> Array:
        """Return one column; with ``aligned``, NaN for points that do not align.

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
        """Return the share of the points in ``among`` that lie in ``of``, NaN without any."""
        found = self.at(of)[self.at(among)] if among else self.at(of)
        return int(np.count_nonzero(found)) / found.size if found.size else NAN


@dataclass(frozen=True)
class Curve(Points):
    """The points of one curve by rising ``x``, the swept parameter, which is a column.

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
        """Return the range that ``between`` does, or the "first tenth" or "last tenth" of x."""
        if text not in ("first tenth", "last tenth"):
            return between(text)
        if not self.x.size:
            return Range(NAN, NAN)
        tenth = _TENTH * float(np.ptp(self.x))
        if text == "first tenth":
            return Range(-math.inf, self.x[0] + tenth)
        return Range(self.x[-1] - tenth, math.inf)

    def within(self, text: str | float) -> "Curve":
        """Return the part of the curve with ``x`` in a range."""
        return self if text == "any" else self.only(self.at({"x": text}))

    def only(self, kept: Flags) -> "Curve":
        """Return the points of ``kept``, shape (n,)."""
        columns = {name: values[kept] for name, values in self.columns.items()}
        return Curve(columns, self.symbol, self.value)

    @cached_property
    def halves(self) -> "tuple[Curve, Curve]":
        """The aligning points, cut in the middle of their range; a point there is in both."""
        found = self.only(self.aligned)
        if not found.x.size:
            return found, found
        middle = 0.5 * (found.x[0] + found.x[-1])
        return found.only(found.x <= middle), found.only(found.x >= middle)


@dataclass(frozen=True)
class Plane:
    """A map: arrays of shape (y, x), NaN in ``tau`` where the part does not align.

    ``regular`` is True for cells that are not sensitive; ``aligned`` is meaningful there only.
    """

    x: Array
    y: Array
    aligned: Flags
    regular: Flags
    tau: Array

    @cached_property
    def largest_area(self) -> float:
        """Share of the aligning cells in the largest connected area; sensitive cells connect."""
        count = int((self.aligned & self.regular).sum())
        if count == 0:
            return 0.0
        areas, found = ndimage.label(self.aligned | ~self.regular)
        sizes = np.bincount(areas[self.aligned & self.regular], minlength=found + 1)
        return float(sizes.max() / count)

    def safe(self, reach: float) -> Flags:
        """Cells around which all align within ``reach`` of both axes' lengths; shape (y, x)."""
        cells = [2 * max(1, round(reach * (size - 1))) + 1 for size in self.aligned.shape]
        lowest = ndimage.minimum_filter((self.aligned | ~self.regular).astype(np.int8), cells)
        return np.asarray(lowest == 1)


@dataclass(frozen=True)
class Course:
    """One trajectory until it aligns or ends, at equidistant moments; shape (n,) each.

    ``x``, ``y`` and ``tilt`` are means over a period of the excitation. ``fall`` is the time from
    the last moment with half the mean contact force until the end, as a share of the duration.
    """

    aligned: bool
    x: Array
    y: Array
    tilt: Array
    force: Array
    fall: float


class Data:
    """Datasets as claims read them; each view of one is made once.

    Args:
        datasets: of figures ("fig06") and of the ledger's own runs ("pressed"), by name.
    """

    def __init__(self, datasets: "Mapping[str, xr.Dataset]") -> None:
        self._datasets = datasets
        self._views: dict[tuple[str, str], object] = {}

    def has(self, name: str) -> bool:
        """Return whether there is such a dataset."""
        return name in self._datasets

    def dataset(self, name: str) -> "xr.Dataset":
        """Return a dataset.

        Raises:
            MissingDataError: there is none of this name; also raised by all that follow.
        """
        if name not in self._datasets:
            raise MissingDataError(f"there is no dataset {name}")
        return self._datasets[name]

    def _view(self, name: str, make: "Callable[[xr.Dataset], Read]") -> Read:
        key = (name, make.__name__)
        if key not in self._views:
            self._views[key] = make(self.dataset(name))
        return self._views[key]  # type: ignore[return-value]

    def curves(self, name: str, at: str | float | list[float] = "any") -> tuple[Curve, ...]:
        """Return the curves of a figure whose parameter lies in a range, by rising value of it.

        ``at`` may also be a list of values, each of which must be there.

        Raises:
            MissingDataError: there is none.
        """
        if isinstance(at, list):
            return tuple(curve for value in at for curve in self.curves(name, value))
        low, high = between(at)
        found = tuple(c for c in self._view(name, _curves) if low <= c.value <= high)
        if not found:
            raise MissingDataError(f"{name} has no curve between {low:g} and {high:g}")
        return found

    def plane(self, name: str) -> Plane:
        """Return the map of a figure."""
        return self._view(name, _plane)

    def course(self, name: str) -> Course:
        """Return the trajectory of a figure."""
        return self._view(name, _course)

    def points(self, name: str) -> Points:
        """Return the points of a dataset."""
        return self._view(name, _points)

    def drawn(self, name: str) -> tuple[Points, ...]:
        """Return what a figure draws: each of its curves, otherwise all its points."""
        return self.curves(name) if name in CURVES else (self.points(name),)

    def held(self, name: str, parameter: str) -> float:
        """Return the value at which a figure holds a parameter."""
        return float(_raw(self.dataset(name), parameter))


def _raw(dataset: "xr.Dataset", name: str) -> NDArray[np.generic]:
    return np.asarray(dataset.variables[name].values)


def _dimensions(dataset: "xr.Dataset") -> tuple[str, ...]:
    return tuple(map(str, dataset.variables["tau_align"].dims))


def _columns(dataset: "xr.Dataset") -> dict[str, NDArray[np.generic]]:
    """The columns of ``Points``, of the shape of the dataset."""
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
    found = []
    for i in np.argsort(values, kind="stable"):
        kept = order[columns["sensitive"][i, order] == 0]
        along = {name: each[i, kept] for name, each in columns.items()}
        found.append(Curve({**along, "x": x[kept]}, symbol, float(values[i])))
    return tuple(found)


def _plane(dataset: "xr.Dataset") -> Plane:
    y, x = _dimensions(dataset)
    aligned = _raw(dataset, "outcome") == _ALIGNED
    return Plane(
        x=_raw(dataset, x).astype(np.float64),
        y=_raw(dataset, y).astype(np.float64),
        aligned=aligned,
        regular=_raw(dataset, "sensitive") == 0,
        tau=np.where(aligned, _raw(dataset, "tau_align"), NAN),
    )


def _course(dataset: "xr.Dataset") -> Course:
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
    # Where a force jumps its time occurs twice: at the end the value before the jump counts.
    until = time <= end
    pressing = _raw(dataset, "contact_force").astype(np.float64)[until]
    strong = time[until][pressing >= 0.5 * max(float(force.mean()), 1e-300)]
    frequency = float(_raw(dataset, "frequency"))
    period = 2.0 * np.pi / frequency if frequency > 0.0 else 0.0
    width = round(period / end * (_MOMENTS - 1))
    return Course(
        aligned=aligned,
        x=_moving_mean(x, width),
        y=_moving_mean(y, width),
        tilt=_moving_mean(tilt, width),
        force=force,
        fall=float((end - strong[-1]) / end) if strong.size else 1.0,
    )


def _moving_mean(values: Array, width: int) -> Array:
    """Mean over ``width`` moments; ``values`` where that is one, or more than half of all."""
    if width < 2 or 2 * width > values.size:
        return values
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")
