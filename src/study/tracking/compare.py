"""Comparison of datasets, of verdicts and of two results folders: `diff`, `verify` and `accept`.

Variables are compared by name, over the points that both datasets have.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from study.csv_tables import read_rows
from study.tracking import TrackingError
from study.tracking.records import Record, changed_inputs, records

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
    """The difference of a variable between two datasets, over their common points."""

    figure: str
    variable: str
    points: int  # points compared
    differing: int  # points at which the values differ
    largest: float  # largest absolute difference of two numbers
    at: dict[str, Any]  # coordinates of the largest difference
    before: float  # the first dataset's value there
    after: float  # the second dataset's value there
    appeared: int  # points with a number in the second dataset only
    vanished: int  # points with a number in the first dataset only


# --- Two datasets -------------------------------------------------------------------------------


def changes_of(before: "xr.Dataset", after: "xr.Dataset", figure: str) -> list[Change]:
    """Return the changes of the numbers that differ, over the common points of both datasets."""
    before, after = common_points(before, after)
    names = [name for name in map(str, after.data_vars) if name in before]
    changes = [
        change_of(before[name], after[name], figure)
        for name in sorted(names)
        if after[name].dtype.kind in "bif" and before[name].dims == after[name].dims
    ]
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
    near = np.zeros(times.shape, dtype=bool)
    for i in np.flatnonzero(np.diff(grid) == 0.0).tolist():
        low, high = grid[max(i - 1, 0)], grid[min(i + 2, grid.size - 1)]
        near |= (times >= low) & (times <= high)
    return near


def change_of(before: "xr.DataArray", after: "xr.DataArray", figure: str) -> Change:
    """Return the change of one variable between two datasets over the same points."""
    old, new = (each.variable.astype(float) for each in (before, after))
    distance = abs(new - old)
    place: dict[Any, int] = {}
    if distance.notnull().any():
        found = distance.fillna(-1.0).argmax(distance.dims)
        place = {name: int(i) for name, i in found.items()} if distance.dims else {}
    named = ((_TIME if _TIME in after.coords else name, i) for name, i in place.items())
    gone, come = new.isnull() & old.notnull(), old.isnull() & new.notnull()
    nothing = float("nan")
    some = bool(distance.notnull().any())
    return Change(
        figure=figure,
        variable=str(after.name),
        points=old.size,
        differing=int((distance > 0.0).sum() + gone.sum() + come.sum()),
        largest=float(distance[place]) if some else 0.0,
        at={str(name): after[name].values[i].item() for name, i in named},
        before=float(old[place]) if some else nothing,
        after=float(new[place]) if some else nothing,
        appeared=int(come.sum()),
        vanished=int(gone.sum()),
    )


# --- Two tables of verdicts ---------------------------------------------------------------------


def changed_verdicts(before: Path, after: Path) -> list[Difference]:
    """Return the claims whose verdicts differ between two tables; the first column names them."""
    return _differences(CLAIMS, _verdicts(before), _verdicts(after))


def _verdicts(path: Path) -> dict[str, str]:
    """Return the verdicts of a table by its first column; a TableError names a file without."""
    named = read_rows(path, "verdicts", lambda row: (next(iter(row.values())), row["verdict"]))
    return dict(named)


def _differences(
    where: str, before: Mapping[str, Any], after: Mapping[str, Any]
) -> list[Difference]:
    """Return the entries that differ, by name; None stands for one that is missing."""
    return [
        Difference(where, name, before.get(name), after.get(name))
        for name in sorted(set(before) | set(after))
        if before.get(name) != after.get(name)
    ]


# --- Two results folders ------------------------------------------------------------------------


@dataclass(frozen=True)
class Comparison:
    """The differences between two folders, and a line for everything that could not be compared.

    ``claims`` is None if the verdicts of a folder are missing or were not made from its data.
    ``other_data`` names files that differ otherwise than by their numbers.
    """

    first: str
    second: str
    parameters: list[Difference] = field(default_factory=list)
    metrics: list[Difference] = field(default_factory=list)
    code: list[Difference] = field(default_factory=list)
    data: list[Change] = field(default_factory=list)
    claims: list[Difference] | None = None
    other_data: list[str] = field(default_factory=list)
    not_compared: list[str] = field(default_factory=list)

    @property
    def differs(self) -> bool:
        """True if the two folders differ in anything."""
        stated = (self.parameters, self.metrics, self.code)
        return any((*stated, self.data, self.other_data, self.claims))


def compare(first: Path, second: Path) -> Comparison:
    """Compare two results folders.

    Raises:
        TrackingError: one is no folder, or holds no results.
    """
    found = Comparison(str(first), str(second))
    runs, other_runs = _runs(first), _runs(second)
    files, other_files = _files(first, runs), _files(second, other_runs)
    for name in _common(runs, other_runs, found) if runs and other_runs else ():
        before, after = runs[name], other_runs[name]
        where = after["figure"] or name
        found.parameters.extend(_differences(where, _stated(before), _stated(after)))
        found.metrics.extend(_differences(where, before.get("counts", {}), after.get("counts", {})))
        found.other_data.extend(
            f"{name}: {table}"
            for table, sha256 in after["outputs"].items()
            if table.endswith(".csv") and table != CLAIMS and not table.startswith("../")  # times
            and before["outputs"].get(table, sha256) != sha256
        )  # fmt: skip
    if runs and other_runs:
        found.code.extend(_differences("code", _code(runs), _code(other_runs)))
    for name in _common(files, other_files, found):
        if name != CLAIMS:
            _compare_data(name, files[name], other_files[name], found)
    if CLAIMS not in files or CLAIMS not in other_files:
        return found
    judged = _are_judged(first, runs, found), _are_judged(second, other_runs, found)
    claims = changed_verdicts(files[CLAIMS], other_files[CLAIMS]) if all(judged) else None
    return replace(found, claims=claims)


def _runs(folder: Path) -> dict[str, Record]:
    """Return the runs of whole results by name."""
    if not folder.is_dir():
        raise TrackingError(f"{folder}: is no results folder")
    return {each["run"]: each for each in records(folder) if not each.get("part")}


def _files(folder: Path, runs: Mapping[str, Record]) -> dict[str, Path]:
    """Return datasets and verdicts by path: "fig06.nc", "claims.csv"."""
    data = folder / "data" if (folder / "data").is_dir() else folder
    found = {path.name: path for path in data.glob("*.nc")}
    if (folder / CLAIMS).is_file():
        found[CLAIMS] = folder / CLAIMS
    if not found and not runs:
        raise TrackingError(f"{folder}: holds neither datasets nor records of the study")
    return found


def _common(
    first: Mapping[str, Any], second: Mapping[str, Any], found: Comparison
) -> Iterator[str]:
    """Yield the names that both have, and note those that only one has."""
    for name in sorted({*first} | {*second}):
        if name in first and name in second:
            yield name
        else:
            only = found.first if name in first else found.second
            found.not_compared.append(f"{name}: only in {only}")


def _stated(run: Record) -> dict[str, Any]:
    """Return parameters, settings and axes of a run as one flat dictionary."""
    settings = {f"settings.{name}": value for name, value in run.get("settings", {}).items()}
    axes = {
        f"{axis['parameter']}.{name}": value
        for axis in run.get("dimensions", [])
        for name, value in axis.items()
        if name != "parameter"
    }
    return {**run.get("parameters", {}), **settings, **axes}


def _code(runs: Mapping[str, Record]) -> dict[str, Any]:
    """Return hashes of the source files and versions of the packages that runs used."""
    return {
        name: used
        for run in runs.values()
        for name, used in {**run["sources"], **run["versions"]}.items()
    }


def _are_judged(folder: Path, runs: Mapping[str, Record], found: Comparison) -> bool:
    """Return True if no data changed since the claims were judged; note it if some did."""
    newer = [str(path.relative_to(folder)) for run in runs.values() if CLAIMS in run["outputs"]
             for path in changed_inputs(run)]  # fmt: skip
    if newer:
        names = ", ".join(newer[:3]) + (", …" if len(newer) > 3 else "")
        found.not_compared.append(
            f"{CLAIMS}: not judged since {names} changed in {folder}: build claims.csv"
        )
    return not newer


def _compare_data(name: str, first: Path, second: Path, found: Comparison) -> None:
    """Compare two datasets of the same name."""
    if first.read_bytes() == second.read_bytes():
        return
    import xarray as xr  # noqa: PLC0415  (a second)

    from model.sweeps.io import read_dataset  # noqa: PLC0415

    before, after = read_dataset(first), read_dataset(second)
    figure = str(after.attrs["figure"])
    if set(before.dims) != set(after.dims):
        found.not_compared.append(f"{figure}: the two vary different parameters")
    elif 0 in common_points(before, after)[1].sizes.values():
        found.not_compared.append(f"{figure}: the two have no point in common")
    elif changes := changes_of(before, after, figure):
        found.data.extend(changes)
    else:
        try:
            xr.testing.assert_identical(before, after)
        except AssertionError as difference:
            found.other_data.append(f"{name}: {' '.join(str(difference).split())}")
