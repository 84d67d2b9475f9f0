"""Comparison of datasets, of verdicts and of two results folders: `diff`, `verify` and `accept`.

Variables are compared by name, over the points that both datasets have.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from study.tracking import TrackingError
from study.tracking.records import Record, changed_inputs, files_of, records

if TYPE_CHECKING:  # the command line works without xarray until data are compared
    import xarray as xr

CLAIMS = "claims.csv"
_TIME = "time"
_SHORT = 1e-6  # of a trajectory: shorter intervals hold its jumps


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

    Two trajectories have different times: both are interpolated in the middle of the intervals of
    the first. A jump, which has its time twice, lies between two of these.
    """
    import xarray as xr  # noqa: PLC0415

    if _TIME not in before.variables:
        return xr.align(before, after, join="inner")
    times = before[_TIME].values
    middles = (0.5 * (times[1:] + times[:-1]))[np.diff(times) > _SHORT]
    at = middles[middles <= after[_TIME].values[-1]]

    def sampled(course: "xr.Dataset") -> "xr.Dataset":
        own, samples = course[_TIME].values, course[_TIME].dims
        values = {
            name: (samples, np.interp(at, own, each.values)) if each.dims == samples else each
            for name, each in course.data_vars.items()
        }
        return xr.Dataset(values, {_TIME: (samples, at)})

    return sampled(before), sampled(after)


def change_of(before: "xr.DataArray", after: "xr.DataArray", figure: str) -> Change:
    """Return the change of one variable between two datasets over the same points."""
    old, new = (np.asarray(each.values, dtype=np.float64) for each in (before, after))
    differ = ~((old == new) | (np.isnan(old) & np.isnan(new)))
    distance = np.zeros(old.shape)
    np.subtract(new, old, out=distance, where=differ & np.isfinite(old) & np.isfinite(new))
    place = np.unravel_index(
        int(np.argmax(np.where(differ, np.abs(distance), -1.0))), distance.shape
    )
    coordinates = [_TIME] if _TIME in after.coords else map(str, after.dims)
    return Change(
        figure=figure,
        variable=str(after.name),
        points=old.size,
        differing=int(differ.sum()),
        largest=float(np.abs(distance[place])),
        at={n: after[n].values[i].item() for n, i in zip(coordinates, place, strict=False)},
        before=float(old[place]),
        after=float(new[place]),
    )


# --- Two tables of verdicts ---------------------------------------------------------------------


def changed_verdicts(before: Path, after: Path) -> list[Difference]:
    """Return the claims whose verdicts differ between two tables.

    Raises:
        ValueError: a file that is no table of claims.
    """
    from study.claims.ledger import read_ledger  # noqa: PLC0415  (scipy)

    first, second = ({e.claim: e.verdict for e in read_ledger(path)} for path in (before, after))
    return _differences(CLAIMS, first, second)


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


@dataclass
class Comparison:
    """The differences between two folders, and a line for everything that could not be compared.

    ``claims`` is None if the verdicts of a folder are missing or were not made from its data.
    ``other_data`` names files that differ otherwise than by their numbers.
    """

    first: str
    second: str
    stated: list[Difference] = field(default_factory=list)  # parameters, settings, axes, counts
    code: list[Difference] = field(default_factory=list)
    data: list[Change] = field(default_factory=list)
    claims: list[Difference] | None = None
    other_data: list[str] = field(default_factory=list)
    not_compared: list[str] = field(default_factory=list)

    @property
    def differs(self) -> bool:
        """True if the two folders differ in anything."""
        return any((self.stated, self.code, self.data, self.claims, self.other_data))


def compare(first: Path, second: Path) -> Comparison:
    """Compare two results folders.

    Raises:
        TrackingError: one is no folder, or holds no results.
    """
    found = Comparison(str(first), str(second))
    runs, other_runs = _runs(first), _runs(second)
    found.code += _differences("code", _code(runs), _code(other_runs))
    for name in sorted({*runs} & {*other_runs}):
        before, after = runs[name], other_runs[name]
        found.stated += _differences(after["figure"] or name, _stated(before), _stated(after))
    files, other_files = _files(first, runs), _files(second, other_runs)
    for name in sorted({*files} ^ {*other_files}):
        found.not_compared.append(f"{name}: only in {first if name in files else second}")
    for name in sorted({*files} & {*other_files}):
        file, other = files[name], other_files[name]
        if name == CLAIMS:
            newer = [*_newer(runs), *_newer(other_runs)]
            found.not_compared += [f"{CLAIMS}: not judged since {each} changed" for each in newer]
            found.claims = None if newer else changed_verdicts(file, other)
        elif file.read_bytes() != other.read_bytes():
            if file.suffix == ".nc":
                _compare_data(name, file, other, found)
            else:
                found.other_data.append(name)
    return found


def _runs(folder: Path) -> dict[str, Record]:
    """Return the runs of whole results by name."""
    if not folder.is_dir():
        raise TrackingError(f"{folder}: is no results folder")
    found = {each["run"]: each for each in records(folder) if not each.get("part")}
    if not found:
        raise TrackingError(f"{folder}: holds no records of the study")
    return found


def _files(folder: Path, runs: Mapping[str, Record]) -> dict[str, Path]:
    """Return datasets and tables that runs made by their paths; CPU times are left out."""
    made = [path for run in runs.values() for path in files_of(run, "outputs")]
    named = {Path(os.path.relpath(path, folder)).as_posix(): path for path in made}
    return {
        name: path
        for name, path in named.items()
        if path.suffix in (".nc", ".csv")
        and path.exists()
        and not name.startswith(("../", "benchmarks/"))
    }


def _stated(run: Record) -> dict[str, Any]:
    """Return parameters, settings, axes and counts of a run as one flat dictionary."""
    parts = {"settings": run.get("settings", {}), "counts": run.get("counts", {})}
    parts |= {axis["parameter"]: axis for axis in run.get("dimensions", [])}
    flat = {f"{part}.{name}": value for part, of in parts.items() for name, value in of.items()}
    return {**run.get("parameters", {}), **flat}


def _code(runs: Mapping[str, Record]) -> dict[str, Any]:
    """Return hashes of the source files and versions of the packages that runs used."""
    used = [{**run["sources"], **run["versions"]} for run in runs.values()]
    return {name: value for each in used for name, value in each.items()}


def _newer(runs: Mapping[str, Record]) -> list[Path]:
    """Return the data that changed since the claims of a folder were judged by them."""
    judging = [run for run in runs.values() if CLAIMS in run["outputs"]]
    return [path for run in judging for path in changed_inputs(run)]


def _compare_data(name: str, first: Path, second: Path, found: Comparison) -> None:
    """Compare two datasets of the same name."""
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
