"""Differences between two results folders: parameters, metrics, code, data and claims."""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from study.tracking import TrackingError
from study.tracking.compare import (
    CLAIMS,
    Change,
    Difference,
    changed_verdicts,
    changes_of,
    common_points,
    differences,
)
from study.tracking.history import Record, sidecars


@dataclass(frozen=True)
class Comparison:
    """The differences between two folders, and a line for everything that could not be compared.

    ``claims`` is None if the verdicts of a folder are missing or were not made from its data.
    ``other_data`` names tables whose bytes differ.
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
    files, other_files = _files(first), _files(second)
    code: list[Difference] = []
    for name in _common(runs, other_runs, found) if runs and other_runs else ():
        before, after = runs[name], other_runs[name]
        where = after["figure"] or name
        found.parameters.extend(differences(where, _stated(before), _stated(after)))
        counts = (each.get("counts", {}) for each in (before, after))
        found.metrics.extend(differences(where, *counts))
        code.extend(differences(name, _code(before), _code(after)))
        found.other_data.extend(_other_bytes(before, after))
    found.code.extend(_by_file(code))
    for name in _common(files, other_files, found):
        if name != CLAIMS:
            found.data.extend(_changes(files[name], other_files[name], found.not_compared))
    if CLAIMS not in files or CLAIMS not in other_files:
        return found
    judged = _are_judged(first, runs, found), _are_judged(second, other_runs, found)
    claims = changed_verdicts(files[CLAIMS], other_files[CLAIMS]) if all(judged) else None
    return replace(found, claims=claims)


def _files(folder: Path) -> dict[str, Path]:
    """Return datasets and verdicts by path: "fig06.nc", "claims/rubbing.nc", "claims.csv"."""
    data = folder / "data" if (folder / "data").is_dir() else folder
    found = {
        path.relative_to(data).as_posix(): path
        for pattern in ("*.nc", "claims/*.nc")
        for path in data.glob(pattern)
    }
    if (folder / CLAIMS).is_file():
        found[CLAIMS] = folder / CLAIMS
    if not found and not _runs(folder):
        raise TrackingError(f"{folder}: holds neither datasets nor sidecars of the study")
    return found


def _runs(folder: Path) -> dict[str, Record]:
    """Return the runs of whole results by name."""
    if not folder.is_dir():
        raise TrackingError(f"{folder}: is no results folder")
    return {each["run"]: each for each in sidecars(folder).values() if not each.get("part")}


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


def _code(run: Record) -> dict[str, Any]:
    """Return hashes of the source files and versions of the packages that a run used."""
    return {**run["sources"], **run["versions"]}


def _by_file(found: list[Difference]) -> Iterator[Difference]:
    """Yield one difference a file or package; many runs may share it."""
    runs: dict[Difference, list[str]] = {}
    for each in found:
        runs.setdefault(replace(each, where=""), []).append(each.where)
    for each, where in runs.items():
        yield replace(each, where=where[0] if len(where) == 1 else f"{len(where)} runs")


def _other_bytes(before: Record, after: Record) -> list[str]:
    """Return the tables of both runs whose bytes differ, apart from CPU times (in ``../``)."""
    return [
        f"{after['run']}: {name}"
        for name, sha256 in after["outputs"].items()
        if name.endswith(".csv")
        and name != CLAIMS
        and not name.startswith("../")
        and before["outputs"].get(name, sha256) != sha256
    ]


def _are_judged(folder: Path, runs: Mapping[str, Record], found: Comparison) -> bool:
    """Return whether the claims were judged since their data changed; note it if they were not."""

    def files(run: Record, kind: str) -> dict[str, str]:
        return {os.path.normpath(Path(run["folder"], name)): sha for name, sha in run[kind].items()}

    made: dict[str, str] = {}
    read: dict[str, str] = {}
    for run in runs.values():
        made |= files(run, "outputs")
        if CLAIMS in run["outputs"]:
            read |= files(run, "inputs")
    newer = sorted(name for name, sha256 in read.items() if made.get(name, sha256) != sha256)
    if newer:
        names = ", ".join(newer[:3]) + (", …" if len(newer) > 3 else "")
        found.not_compared.append(
            f"{CLAIMS}: not judged since {names} changed in {folder}: build claims.csv"
        )
    return not newer


def _changes(first: Path, second: Path, not_compared: list[str]) -> list[Change]:
    """Return the changes of the variables of two datasets of the same name."""
    if first.read_bytes() == second.read_bytes():
        return []
    from model.sweeps.io import read_dataset  # noqa: PLC0415  (xarray: a second)

    before, after = read_dataset(first), read_dataset(second)
    figure = str(after.attrs["figure"])
    if before["outcome"].dims != after["outcome"].dims:
        not_compared.append(f"{figure}: the two vary different parameters")
        return []
    if 0 in common_points(before, after)[1].sizes.values():
        not_compared.append(f"{figure}: the two have no point in common")
        return []
    return sorted(changes_of(before, after, figure), key=lambda each: each.variable)
