"""How claims read datasets: curves, planes and courses, without what is not to be relied on.

A sensitive point ends differently at another tolerance. Whatever is read here leaves such points
out, neither aligned nor not, so that they decide nothing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from model.events.outcomes import Outcome

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

NAN = float("nan")
RESOLUTION = 0.005  # two values closer than this, relative to their median, count as equal
_ALONG = (
    "outcome", "tau_align", "sensitive", "tilt_max", "tilt_at_alignment", "contact_force_max",
    "tilt_end", "way", "excursion", "side_force_max",
)  # fmt: skip
_OF_POINTS = ("outcome", "tau_align", "separations", "tau_corners_inside")
_ALIGNED = int(Outcome.ALIGNED)  # comparing arrays with the enumeration takes five times as long
_TIMES = 200  # moments at which a course is looked at


class MissingDataError(LookupError):
    """Nothing to judge a claim by: a dataset, or what it would have to vary; the message says."""


class Curve(NamedTuple):
    """One curve of a figure, without its sensitive points; all arrays of shape (n,).

    Attributes:
        at: value of the family's parameter.
        x: the swept parameter, rising.
        aligned: whether the part aligns.
        tau: alignment duration, NaN where it does not align.
        rows: other variables along the curve, by name.
    """

    at: float
    x: Array
    aligned: Flags
    tau: Array
    rows: Mapping[str, Array]

    def within(self, low: float, high: float) -> "Curve":
        """The part of the curve with low <= x <= high."""
        return self.only((self.x >= low) & (self.x <= high))

    def only(self, kept: Flags) -> "Curve":
        """The points of ``kept``."""
        rows = {name: values[kept] for name, values in self.rows.items()}
        return Curve(self.at, self.x[kept], self.aligned[kept], self.tau[kept], rows)

    @property
    def share_aligned(self) -> float:
        """Share of the points that align, NaN without any point."""
        return float(self.aligned.mean()) if self.aligned.size else NAN


@dataclass(frozen=True)
class Plane:
    """A map: arrays of shape (y, x), NaN in ``tau`` where the part does not align.

    ``regular`` says which cells are not sensitive; ``aligned`` is meaningful in those only.
    """

    x: Array
    y: Array
    aligned: Flags
    regular: Flags
    tau: Array

    @cached_property
    def share_aligned(self) -> float:
        """Share of the regular cells that align."""
        return float(self.aligned[self.regular].mean()) if self.regular.any() else NAN

    @cached_property
    def largest_area(self) -> float:
        """Share of the aligning cells that hang together; sensitive cells connect others."""
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

    ``fall`` is how long before that moment the contact force last was half its mean, as a share of
    the duration; ``force_after`` is the largest contact force after it.
    """

    aligned: bool
    duration: float
    x: Array
    y: Array
    tilt: Array
    force: Array
    drive: Array
    fall: float
    force_after: float


class Data:
    """Datasets as claims read them; what is read twice is prepared once.

    Args:
        datasets: of figures ("fig06") and of the ledger's own runs ("pressed"), by name.
    """

    def __init__(self, datasets: "Mapping[str, xr.Dataset]") -> None:
        self._datasets = datasets
        self._curves: dict[str, tuple[Curve, ...]] = {}
        self._planes: dict[str, Plane] = {}
        self._regular: dict[str, dict[str, Array]] = {}

    def has(self, name: str) -> bool:
        """Whether there is such a dataset."""
        return name in self._datasets

    def dataset(self, name: str) -> "xr.Dataset":
        """A dataset.

        Raises:
            MissingDataError: there is none of this name.
        """
        if name not in self._datasets:
            raise MissingDataError(f"there is no dataset {name}")
        return self._datasets[name]

    def curves(self, name: str) -> tuple[Curve, ...]:
        """The curves of a figure by rising value of their parameter.

        Raises:
            MissingDataError: there is no such dataset.
        """
        if name not in self._curves:
            self._curves[name] = _curves(self.dataset(name))
        return self._curves[name]

    def curve(self, name: str, at: float) -> Curve:
        """The curve at a value of the family's parameter.

        Raises:
            MissingDataError: there is no such curve.
        """
        for curve in self.curves(name):
            if curve.at == at:
                return curve
        raise MissingDataError(f"{name} has no curve at {at:g}")

    def between(self, name: str, low: float, high: float) -> tuple[Curve, ...]:
        """The curves whose parameter lies between two values, both included.

        Raises:
            MissingDataError: there is none.
        """
        found = tuple(curve for curve in self.curves(name) if low <= curve.at <= high)
        if not found:
            raise MissingDataError(f"{name} has no curve between {low:g} and {high:g}")
        return found

    def plane(self, name: str) -> Plane:
        """The map of a figure.

        Raises:
            MissingDataError: there is no such dataset.
        """
        if name not in self._planes:
            self._planes[name] = _plane(self.dataset(name))
        return self._planes[name]

    def course(self, name: str) -> Course:
        """The trajectory of a figure.

        Raises:
            MissingDataError: there is no such dataset.
        """
        return _course(self.dataset(name))

    def regular(self, name: str) -> dict[str, Array]:
        """The regular points of a dataset, flat, by variable, with an ``aligned`` flag."""
        if name not in self._regular:
            dataset = self.dataset(name)
            kept = np.atleast_1d(_raw(dataset, "sensitive")).ravel() == 0
            rows = {each: np.atleast_1d(_raw(dataset, each)).ravel()[kept] for each in _OF_POINTS}
            self._regular[name] = {**rows, "aligned": rows["outcome"] == _ALIGNED}
        return self._regular[name]

    def held(self, name: str, parameter: str) -> float:
        """The value at which a figure holds a parameter."""
        return float(_raw(self.dataset(name), parameter))


def _raw(dataset: "xr.Dataset", name: str) -> NDArray[np.generic]:
    return np.asarray(dataset.variables[name].values)


def _names(dataset: "xr.Dataset") -> tuple[str, str]:
    first, second = map(str, dataset.variables["tau_align"].dims)
    return first, second


def _curves(dataset: "xr.Dataset") -> tuple[Curve, ...]:
    family, swept = _names(dataset)
    x, values = (_raw(dataset, name).astype(np.float64) for name in (swept, family))
    rows = {name: _raw(dataset, name) for name in _ALONG if name in dataset.variables}
    order = np.argsort(x, kind="stable")
    found = []
    for i in np.argsort(values, kind="stable"):
        kept = order[rows["sensitive"][i, order] == 0]
        along = {name: row[i, kept] for name, row in rows.items()}
        aligned = along["outcome"] == _ALIGNED
        tau = np.where(aligned, along["tau_align"], NAN)
        found.append(Curve(float(values[i]), x[kept], aligned, tau, along))
    return tuple(found)


def _plane(dataset: "xr.Dataset") -> Plane:
    y, x = _names(dataset)
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
    moments = np.linspace(0.0, end, _TIMES)
    x, y, tilt, force = (
        np.interp(moments, time, _raw(dataset, name).astype(np.float64))
        for name in ("x", "y", "tilt", "contact_force")
    )
    # Where a force jumps the same time stands twice: at the end the value before the jump counts.
    pressing = _raw(dataset, "contact_force").astype(np.float64)
    until, after = time <= end, time > end
    strong = time[until][pressing[until] >= 0.5 * max(float(force.mean()), 1e-300)]
    period = _period(_raw(dataset, "frequency"))
    smooth = [_without_vibration(each, period / end * (_TIMES - 1)) for each in (x, y, tilt)]
    return Course(
        aligned=aligned,
        duration=end,
        x=smooth[0],
        y=smooth[1],
        tilt=smooth[2],
        force=force,
        drive=force * np.sin(tilt),
        fall=float((end - strong[-1]) / end) if strong.size else 1.0,
        force_after=float(pressing[after].max()) if after.any() else NAN,
    )


def _period(frequency: NDArray[np.generic]) -> float:
    value = float(frequency)
    return 2.0 * np.pi / value if value > 0.0 else 0.0


def _without_vibration(values: Array, moments: float) -> Array:
    """Mean over a period of the excitation, ``moments`` long; as it is where that is too much."""
    width = round(moments)
    if width < 2 or 2 * width > values.size:
        return values
    return np.convolve(values, np.full(width, 1.0 / width), mode="valid")


# --- Numbers of curves --------------------------------------------------------------------------


def trend(x: Array, y: Array) -> float:
    """How surely ``y`` rises with ``x``: 1 always, 0 no trend, -1 it falls; NaN if unknown.

    Kendall's rank correlation: of all pairs of points, the share that rise less the share that
    fall. Pairs closer than ``RESOLUTION`` count as equal, and points with NaN are left out.

    Args:
        x: shape (n,).
        y: shape (n,), or (m, n) for the mean over m rows of those that have two points.
    """
    if y.ndim == 2:
        return mean_of([trend(x, row) for row in y])
    known = np.isfinite(y)
    if known.sum() < 2:
        return NAN
    x, y = x[known], y[known]
    rise = y[None, :] - y[:, None]
    signs = np.where(np.abs(rise) > RESOLUTION * abs(quantile(y, 0.5)), np.sign(rise), 0.0)
    return float((signs * np.sign(x[None, :] - x[:, None])).sum() / (x.size * (x.size - 1)))


def mean_of(values: Sequence[float]) -> float:
    """Mean of what is a number, NaN where nothing is."""
    known = [value for value in values if value == value]  # noqa: PLR0124  (NaN is not itself)
    return sum(known) / len(known) if known else NAN


def slope(x: Array, y: Array) -> float:
    """Slope of the straight line nearest to the points, NaN without two of them."""
    known = np.isfinite(y)
    if known.sum() < 2:
        return NAN
    x, y = x[known] - x[known].mean(), y[known]
    return float((x * y).sum() / (x * x).sum())


def explained(basis: Array, y: Array) -> float:
    """Share of the variance of ``y`` that a combination of ``basis``, shape (k, n), explains.

    0 where the mean alone does better; NaN with fewer than k + 2 points, or where ``y`` does not
    vary.
    """
    known = np.isfinite(y)
    if known.sum() < len(basis) + 2 or np.ptp(y[known]) == 0.0:
        return NAN
    matrix, y = basis[:, known].T, y[known]
    residual = y - matrix @ np.linalg.lstsq(matrix, y, rcond=None)[0]
    return max(0.0, float(1.0 - (residual**2).sum() / ((y - y.mean()) ** 2).sum()))


def quantile(values: Array, share: float) -> float:
    """As numpy's, for a filled array without NaN; a tenth of its time for few values."""
    ordered = np.sort(values)
    place = share * (ordered.size - 1)
    low = int(place)
    high = min(low + 1, ordered.size - 1)
    return float(ordered[low] + (place - low) * (ordered[high] - ordered[low]))


def middle(values: Array) -> float:
    """Median of what is a number, NaN where nothing is."""
    known = values[np.isfinite(values)]
    return quantile(known, 0.5) if known.size else NAN


def spread(values: Array) -> float:
    """Largest over smallest of the middle nine tenths of what is a number, NaN where nothing is."""
    known = values[np.isfinite(values)]
    if known.size == 0:
        return NAN
    return ratio(quantile(known, 0.95), quantile(known, 0.05))


def ratio(first: float, second: float) -> float:
    """First / second, NaN where there is none."""
    return first / second if second != 0.0 else NAN


def asymmetry(first: float, second: float) -> float:
    """(first - second) / (|first| + |second|): from -1 to 1, 0 where they are equal."""
    total = abs(first) + abs(second)
    return (first - second) / total if total != 0.0 else 0.0
