"""Comparison of datasets and of verdicts, for `python -m study diff`, `verify` and `accept`.

Variables are compared by name, over the points that both datasets have. xarray aligns the points;
its ``testing.assert_allclose`` is not used, because it says neither where data differ nor by how
much.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from study.tracking import TrackingError

if TYPE_CHECKING:  # the command line works without xarray until data are compared
    import xarray as xr

CLAIMS = "claims.csv"
_TIME = "time"


@dataclass(frozen=True)
class Difference:
    """One value that differs; ``where`` names its figure, or its run if that has no figure."""

    where: str
    name: str
    before: Any
    after: Any


@dataclass(frozen=True)
class Change:
    """The difference of a variable between two datasets of a figure, over their common points."""

    figure: str
    variable: str
    points: int  # points compared
    differing: int  # points at which the values differ
    largest: float  # largest absolute difference of two numbers
    at: dict[str, float]  # coordinates of the largest difference
    before: float  # the first dataset's value there
    after: float  # the second dataset's value there
    appeared: int  # points with a number in the second dataset only
    vanished: int  # points with a number in the first dataset only


def differences(
    where: str, before: Mapping[str, Any], after: Mapping[str, Any]
) -> list[Difference]:
    """Return the entries that differ, by name; None stands for one that is missing."""
    return [
        Difference(where, name, before.get(name), after.get(name))
        for name in sorted(set(before) | set(after))
        if before.get(name) != after.get(name)
    ]


def changed_verdicts(before: Path, after: Path) -> list[Difference]:
    """Return the claims whose verdicts differ between two tables; the first column names them."""
    return differences(CLAIMS, _verdicts(before), _verdicts(after))


def _verdicts(path: Path) -> dict[str, str]:
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            rows = csv.DictReader(stream)
            names = rows.fieldnames or []
            if "verdict" in names:
                return {row[names[0]]: row["verdict"] for row in rows}
    except (UnicodeDecodeError, csv.Error):
        names = ["no table"]
    raise TrackingError(
        f"{path}: has no column 'verdict', but {', '.join(names) or 'nothing'}: build it again"
    )


def changes_of(before: "xr.Dataset", after: "xr.Dataset", figure: str) -> list[Change]:
    """Return the changes of the variables that differ, over the common points of both datasets."""
    before, after = common_points(before, after)
    names = [name for name in map(str, after.data_vars) if name in before]
    changes = [change_of(before[name], after[name], figure) for name in names]
    return [change for change in changes if change.differing]


def common_points(before: "xr.Dataset", after: "xr.Dataset") -> "tuple[xr.Dataset, xr.Dataset]":
    """Return both datasets at their common points.

    Two trajectories have different times: the second is interpolated at the times of the first.
    Times near a jump of a force are left out.
    """
    import xarray as xr  # noqa: PLC0415

    if _TIME not in before.variables:
        return xr.align(before, after, join="inner")
    (samples,), of_after = before[_TIME].dims, after[_TIME].dims
    times, other = before[_TIME].values, after[_TIME].values
    smooth = (times <= other[-1]) & ~_near_jump(times, times) & ~_near_jump(times, other)
    kept = np.flatnonzero(smooth)
    moved = {
        name: (samples, np.interp(times[kept], other, variable.values), variable.attrs)
        if variable.dims == of_after
        else variable
        for name, variable in after.data_vars.items()
    }
    at = {_TIME: (samples, times[kept])}
    return before.isel({samples: kept}), xr.Dataset(moved, at, attrs=after.attrs)


def _near_jump(times: NDArray[np.float64], grid: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return a mask of the ``times`` within a step of a jump, a time that ``grid`` has twice."""
    twice: list[int] = np.flatnonzero(np.diff(grid) == 0.0).tolist()
    near = np.zeros(times.shape, dtype=bool)
    for i in twice:
        low, high = grid[max(i - 1, 0)], grid[min(i + 2, grid.size - 1)]
        near |= (times >= low) & (times <= high)
    return near


def change_of(before: "xr.DataArray", after: "xr.DataArray", figure: str) -> Change:
    """Return the change of one variable between two datasets over the same points."""
    old, new = (np.asarray(each.values, dtype=np.float64) for each in (before, after))
    distance = np.abs(new - old)
    known = np.isfinite(distance)
    at: dict[str, float] = {}
    largest, values = 0.0, (float("nan"), float("nan"))
    if known.any():
        worst = int(np.argmax(np.where(known, distance, -1.0)))
        place = tuple(map(int, np.unravel_index(worst, distance.shape)))
        largest, values = float(distance[place]), (float(old[place]), float(new[place]))
        named = ((_TIME if _TIME in after.coords else name, i)
                 for name, i in zip(after.dims, place, strict=True))  # fmt: skip
        at = {str(name): float(after[name].values[i]) for name, i in named}
    gone, come = np.isnan(new) & ~np.isnan(old), np.isnan(old) & ~np.isnan(new)
    return Change(
        figure=figure,
        variable=str(after.name),
        points=int(old.size),
        differing=int((known & (distance > 0.0)).sum() + gone.sum() + come.sum()),
        largest=largest,
        at=at,
        before=values[0],
        after=values[1],
        appeared=int(come.sum()),
        vanished=int(gone.sum()),
    )
