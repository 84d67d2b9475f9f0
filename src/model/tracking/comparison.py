"""Differences between two states of the study: parameters, metrics, data and claims.

Everything is compared by name, and data point by point where both have the point. xarray aligns
them; its own ``testing.assert_allclose`` was weighed, and says neither where nor by how much.
"""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from model.tracking import TrackingError
from model.tracking.history import Record, kept_outputs
from model.tracking.snapshot import CLAIMS, Snapshot

if TYPE_CHECKING:  # the command line works without xarray until data are compared
    import xarray as xr

_TIME = "time"


@dataclass(frozen=True)
class Difference:
    """One value that differs; ``where`` is the figure, or the run if it belongs to none."""

    where: str
    name: str
    before: Any
    after: Any


@dataclass(frozen=True)
class Change:
    """The difference of a variable of a figure's dataset, over the points that both states have.

    Attributes:
        figure: such as "fig06".
        variable: its name in the dataset.
        points: how many points are compared.
        differing: how many of them differ at all.
        largest: largest absolute difference where both are numbers.
        at: where that is, by coordinate.
        before: the value there, first state.
        after: the value there, second state.
        appeared: points that have a number in the second state only.
        vanished: points that have a number in the first state only.
    """

    figure: str
    variable: str
    points: int
    differing: int
    largest: float
    at: dict[str, float]
    before: float
    after: float
    appeared: int
    vanished: int


@dataclass(frozen=True)
class Comparison:
    """Everything that differs between two states, and what could not be compared.

    ``claims`` is None where one of the two has no verdicts on its own data. ``other_data`` names
    datasets that are no figure's and differ in bytes: no copies are kept to say by how much.
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
        """True if the two states differ in anything."""
        stated = (self.parameters, self.metrics, self.code)
        return any((*stated, self.data, self.other_data, self.claims))


def compare(first: Snapshot, second: Snapshot) -> Comparison:
    """Compare two states.

    Raises:
        TrackingError: a dataset that cannot be read, or xarray missing.
    """
    comparison = Comparison(first.label, second.label, claims=None)
    code_differences: list[Difference] = []
    for before, after in _pairs(first, second, comparison.not_compared):
        where = after["figure"] or after["run"]
        counts = (each.get("counts", {}) for each in (before, after))
        code = (
            {**each.get("sources", {"code": each["code"]}), **each["versions"]}
            for each in (before, after)
        )
        comparison.parameters.extend(_differences(where, _stated(before), _stated(after)))
        comparison.metrics.extend(_differences(where, *counts))
        code_differences.extend(_differences(after["run"], *code))
        if not kept_outputs(after):
            comparison.other_data.extend(_other_bytes(before, after))
    comparison.code.extend(_by_file(code_differences))
    for name in sorted(set(first.files) | set(second.files)):
        if name not in first.files or name not in second.files:
            holder = first if name in first.files else second
            comparison.not_compared.append(f"{name}: only in {holder.label}")
        elif name != CLAIMS:
            comparison.data.extend(_data_changes(first.files[name], second.files[name], comparison))
    if CLAIMS in first.files and CLAIMS in second.files:
        comparison = replace(comparison, claims=_claims(first, second, comparison.not_compared))
    for each in (first, second):
        comparison.not_compared.extend(
            f"{name}: no copy is kept of what {each.label} made" for name in each.lost
        )
    return comparison


def _by_file(differences: list[Difference]) -> Iterator[Difference]:
    """Yield one difference for each file or package, which many runs may share."""
    runs: dict[Difference, list[str]] = {}
    for each in differences:
        runs.setdefault(replace(each, where=""), []).append(each.where)
    for each, where in runs.items():
        yield replace(each, where=where[0] if len(where) == 1 else f"{len(where)} runs")


def _claims(first: Snapshot, second: Snapshot, not_compared: list[str]) -> list[Difference] | None:
    """Compare the verdicts, unless one of the two was not judged by its own data."""
    for each in (first, second):
        if newer := each.newer_than_claims():
            files = ", ".join(newer[:3]) + (", …" if len(newer) > 3 else "")
            not_compared.append(
                f"{CLAIMS}: not judged since {files} changed in {each.label}: build claims.csv"
            )
            return None
    return changed_verdicts(first.files[CLAIMS], second.files[CLAIMS])


def _pairs(
    first: Snapshot, second: Snapshot, not_compared: list[str]
) -> Iterator[tuple[Record, Record]]:
    """Yield the runs to compare: those of one name, or the only two there are."""
    if len(first.runs) == len(second.runs) == 1:
        yield next(iter(first.runs.values())), next(iter(second.runs.values()))
        return
    wholes = [
        {name: run for name, run in each.runs.items() if not run.get("part")}
        for each in (first, second)
    ]
    if not all(wholes):
        return
    for name in sorted(set(wholes[0]) ^ set(wholes[1])):
        holder = first if name in wholes[0] else second
        not_compared.append(f"{name}: only in {holder.label}")
    for name in sorted(set(wholes[0]) & set(wholes[1])):
        yield wholes[0][name], wholes[1][name]


def _differences(
    where: str, before: Mapping[str, Any], after: Mapping[str, Any]
) -> list[Difference]:
    return [
        Difference(where, name, before.get(name), after.get(name))
        for name in sorted(set(before) | set(after))
        if before.get(name) != after.get(name)
    ]


def _stated(run: Record) -> dict[str, Any]:
    """Return parameters, settings and varied axes, one level deep."""
    stated = dict(run.get("parameters", {}))
    for name, value in run.get("settings", {}).items():
        stated |= {f"settings.{name}": value}
    for axis in run.get("dimensions", []):
        stated |= {
            f"{axis['parameter']}.{name}": value
            for name, value in axis.items()
            if name != "parameter"
        }
    return stated


def _other_bytes(before: Record, after: Record) -> list[str]:
    """Return the datasets of both runs that differ; CPU times, in another folder, do not count."""
    return [
        f"{after['run']}: {name}"
        for name, sha256 in after["outputs"].items()
        if name.endswith((".nc", ".csv"))
        and not name.startswith("../")
        and before["outputs"].get(name, sha256) != sha256
    ]


def changed_verdicts(before: Path, after: Path) -> list[Difference]:
    """Return the claims with different verdicts in two tables; the first column names the claim.

    Raises:
        TrackingError: a table without verdicts.
    """
    return _differences(CLAIMS, _verdicts(before), _verdicts(after))


def _verdicts(path: Path) -> dict[str, str]:
    with path.open(encoding="utf-8", newline="") as stream:
        rows = csv.DictReader(stream)
        names = rows.fieldnames or []
        if "verdict" not in names:
            raise TrackingError(f"{path}: has no column 'verdict', but {', '.join(names)}")
        return {row[names[0]]: row["verdict"] for row in rows}


# --- Data ---------------------------------------------------------------------------------------


def open_dataset(path: Path) -> "xr.Dataset":
    """Read a dataset of the study.

    Raises:
        TrackingError: not a dataset, or xarray is missing.
    """
    try:
        from model.study.io import DatasetError, read_dataset  # noqa: PLC0415  (slow)
    except ImportError:
        raise TrackingError(
            "comparing data needs xarray, which is not installed: pip install 'vibralign[study]'"
        ) from None
    try:
        return read_dataset(path)
    except DatasetError as error:
        raise TrackingError(str(error)) from None


def _data_changes(first: Path, second: Path, comparison: Comparison) -> list[Change]:
    if first.read_bytes() == second.read_bytes():
        return []
    before, after = open_dataset(first), open_dataset(second)
    figure = str(after.attrs["figure"])
    if before["tau_align"].dims != after["tau_align"].dims:
        comparison.not_compared.append(f"{figure}: the two vary different parameters")
        return []
    if 0 in common_points(before, after)[1].sizes.values():
        comparison.not_compared.append(f"{figure}: the two have no point in common")
        return []
    return sorted(changes_of(before, after, figure), key=lambda each: each.variable)


def changes_of(before: "xr.Dataset", after: "xr.Dataset", figure: str) -> list[Change]:
    """Return the changes of the variables that differ, over the common points of both datasets."""
    before, after = common_points(before, after)
    names = [name for name in map(str, after.data_vars) if name in before]
    changes = [change_of(before[name], after[name], figure) for name in names]
    return [change for change in changes if change.differing]


def common_points(before: "xr.Dataset", after: "xr.Dataset") -> "tuple[xr.Dataset, xr.Dataset]":
    """Restrict both datasets to their common points.

    Two trajectories have no common points: the second is interpolated to the times of the
    first, away from the moments at which a force jumps.
    """
    import xarray as xr  # noqa: PLC0415

    if _TIME not in before.dims:
        return xr.align(before, after, join="inner")
    times, other = before[_TIME].values, after[_TIME].values
    smooth = (times <= other[-1]) & ~_near_jump(times, times) & ~_near_jump(times, other)
    kept = np.flatnonzero(smooth)
    moved = {
        name: (_TIME, np.interp(times[kept], other, variable.values), variable.attrs)
        if variable.dims == (_TIME,)
        else variable
        for name, variable in after.data_vars.items()
    }
    return before.isel({_TIME: kept}), xr.Dataset(moved, {_TIME: times[kept]}, attrs=after.attrs)


def _near_jump(times: NDArray[np.float64], grid: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether each of ``times`` is within a step of a moment that ``grid`` has twice."""
    twice: list[int] = np.flatnonzero(np.diff(grid) == 0.0).tolist()
    near = np.zeros(times.shape, dtype=bool)
    for i in twice:
        low, high = grid[max(i - 1, 0)], grid[min(i + 2, grid.size - 1)]
        near |= (times >= low) & (times <= high)
    return near


def change_of(before: "xr.DataArray", after: "xr.DataArray", figure: str) -> Change:
    """Compare one variable over the same points."""
    old, new = (np.asarray(each.values, dtype=np.float64) for each in (before, after))
    distance = np.abs(new - old)
    known = np.isfinite(distance)
    place: tuple[int, ...] = ()
    largest = 0.0
    if known.any():
        place = tuple(
            int(i)
            for i in np.unravel_index(np.argmax(np.where(known, distance, -1.0)), distance.shape)
        )
        largest = float(distance[place])
    gone, come = np.isnan(new) & ~np.isnan(old), np.isnan(old) & ~np.isnan(new)
    at = {
        str(name): float(after[name].values[i]) for name, i in zip(after.dims, place, strict=False)
    }
    return Change(
        figure=figure,
        variable=str(after.name),
        points=int(old.size),
        differing=int((known & (distance > 0.0)).sum() + gone.sum() + come.sum()),
        largest=largest,
        at=at,
        before=float(old[place]) if known.any() else float("nan"),
        after=float(new[place]) if known.any() else float("nan"),
        appeared=int(come.sum()),
        vanished=int(gone.sum()),
    )
