"""Differences between two states of the study: parameters, metrics, code, data and claims.

A state is a results folder as it is now, or an earlier state that the history keeps.
"""

import os
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from model.tracking import TrackingError
from model.tracking.compare import (
    CLAIMS,
    Change,
    Difference,
    changed_verdicts,
    changes_of,
    common_points,
    differences,
)
from model.tracking.history import (
    Record,
    find_invocation,
    find_run,
    kept_outputs,
    kept_result,
    load_history,
    load_runs,
    sidecars,
)

# --- States -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Snapshot:
    """The state of the study at one moment."""

    label: str  # the name that the user gave
    runs: Mapping[str, Record]  # the latest run of every name
    files: Mapping[str, Path]  # datasets and verdicts by file name: "fig06.nc", "claims.csv"
    lost: tuple[str, ...] = ()  # names of those of which the history has no copy


def snapshot(name: str, root: Path) -> Snapshot:
    """Return the state of the study that ``name`` denotes.

    It is a results folder, or an entry of the history below ``root``: a run ("merge/fig06",
    "merge/fig06@INVOCATION"), an invocation ("last", or the beginning of its name), or a commit at
    which the study was built (any name that git knows).
    """
    if Path(name).is_dir():
        return _of_folder(Path(name))
    history, runs = load_history(root), load_runs(root)
    if name.partition("@")[0] in {run["run"] for run in runs}:
        run = find_run([run for run in runs if run["status"] == "done"], name)
        return _of_runs(name, [run], root)
    if name == "last" or any(each["invocation"].startswith(name) for each in history):
        last = find_invocation(history, name)
    else:
        last = _invocation_of_commit(history, name, root)
    until = [each for each in history if each["started"] <= last["started"]]
    return _of_runs(name, [run for each in until for run in each["runs"]], root)


def _of_folder(folder: Path) -> Snapshot:
    data = folder / "data" if (folder / "data").is_dir() else folder
    files = {path.name: path for path in sorted(data.glob("fig*.nc"))}
    if (folder / CLAIMS).is_file():
        files[CLAIMS] = folder / CLAIMS
    runs = {record["run"]: record for record in sidecars(folder).values()}
    if not files and not runs:
        raise TrackingError(f"{folder}: holds neither datasets nor sidecars of the study")
    return Snapshot(str(folder), runs, files)


def _of_runs(label: str, runs: Iterable[Record], root: Path) -> Snapshot:
    latest = {run["run"]: run for run in runs}
    kept = {
        name: kept_result(root, name, sha256)
        for run in latest.values()
        for name, sha256 in kept_outputs(run).items()
    }
    files = {name: path for name, path in kept.items() if path.is_file()}
    return Snapshot(label, latest, files, tuple(name for name in kept if name not in files))


def _invocation_of_commit(history: Sequence[Record], name: str, root: Path) -> Record:
    question = ["git", "rev-parse", "--verify", "--quiet", f"{name}^{{commit}}"]
    git = subprocess.run(question, capture_output=True, text=True, check=False)
    commit = git.stdout.strip() or name
    for each in reversed(history):
        was_refused = not each["runs"] and each["outcome"] != "done"
        if each["git"].get("commit", "").startswith(commit) and not was_refused:
            return each
    raise TrackingError(
        f"{name!r} is no results folder, and neither a run, an invocation nor a commit in "
        f"{root / 'history'}; to compare with another commit, build it in a checkout of its own "
        "(git worktree add) and name its results folder"
    )


# --- What differs -------------------------------------------------------------------------------


@dataclass(frozen=True)
class Comparison:
    """The differences between two states, and a line for everything that could not be compared.

    ``claims`` is None if the verdicts of a state are missing or were not made from its data.
    ``other_data`` names datasets besides the figures' whose bytes differ: the history keeps no
    copies of these, so that the size of the difference is unknown.
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
    """Compare two states."""
    found = Comparison(first.label, second.label)
    code: list[Difference] = []
    for before, after in _pairs(first, second, found.not_compared):
        where = after["figure"] or after["run"]
        found.parameters.extend(differences(where, _stated(before), _stated(after)))
        counts = (each.get("counts", {}) for each in (before, after))
        found.metrics.extend(differences(where, *counts))
        code.extend(differences(after["run"], _code(before), _code(after)))
        if not kept_outputs(after):
            found.other_data.extend(_other_bytes(before, after))
    found.code.extend(_by_file(code))
    found.not_compared.extend(_in_one_only(first, second, "files"))
    for name in sorted({*first.files} & {*second.files} - {CLAIMS}):
        found.data.extend(_data_changes(first.files[name], second.files[name], found.not_compared))
    claims = None
    if CLAIMS in first.files and CLAIMS in second.files:
        claims = _claims(first, second, found.not_compared)
    found.not_compared.extend(
        f"{name}: no copy is kept of what {each.label} made"
        for each in (first, second)
        for name in each.lost
    )
    return replace(found, claims=claims)


def _pairs(
    first: Snapshot, second: Snapshot, not_compared: list[str]
) -> Iterator[tuple[Record, Record]]:
    """Yield pairs of runs to compare: runs of the same name; or two single runs of any name."""
    if len(first.runs) == len(second.runs) == 1:
        yield next(iter(first.runs.values())), next(iter(second.runs.values()))
        return
    before, after = (
        replace(each, runs={n: run for n, run in each.runs.items() if not run.get("part")})
        for each in (first, second)
    )
    if before.runs and after.runs:
        not_compared.extend(_in_one_only(before, after, "runs"))
        for name in sorted({*before.runs} & {*after.runs}):
            yield before.runs[name], after.runs[name]


def _in_one_only(first: Snapshot, second: Snapshot, what: str) -> Iterator[str]:
    """Yield a line for each of the "runs" or "files" that only one of the states has."""
    names, others = getattr(first, what), getattr(second, what)
    for name in sorted({*names} ^ {*others}):
        yield f"{name}: only in {(first if name in names else second).label}"


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
    """Return the datasets of both runs whose bytes differ, apart from CPU times (in ``../``)."""
    return [
        f"{after['run']}: {name}"
        for name, sha256 in after["outputs"].items()
        if name.endswith((".nc", ".csv"))
        and not name.startswith("../")
        and before["outputs"].get(name, sha256) != sha256
    ]


# --- Claims and data ----------------------------------------------------------------------------


def _claims(first: Snapshot, second: Snapshot, not_compared: list[str]) -> list[Difference] | None:
    """Compare the verdicts; return None if those of a state were not made from its data."""
    for each in (first, second):
        if newer := _changed_since_judged(each):
            files = ", ".join(newer[:3]) + (", …" if len(newer) > 3 else "")
            not_compared.append(
                f"{CLAIMS}: not judged since {files} changed in {each.label}: build claims.csv"
            )
            return None
    return changed_verdicts(first.files[CLAIMS], second.files[CLAIMS])


def _changed_since_judged(state: Snapshot) -> list[str]:
    """Return the input files of the claims that changed since the claims were judged."""

    def files(run: Record, kind: str) -> dict[str, str]:
        return {os.path.normpath(Path(run["folder"], name)): sha for name, sha in run[kind].items()}

    made: dict[str, str] = {}
    read: dict[str, str] = {}
    for run in state.runs.values():
        made |= files(run, "outputs")
        if CLAIMS in run["outputs"]:
            read |= files(run, "inputs")
    return sorted(name for name, sha256 in read.items() if made.get(name, sha256) != sha256)


def _data_changes(first: Path, second: Path, not_compared: list[str]) -> list[Change]:
    if first.read_bytes() == second.read_bytes():
        return []
    from model.sweeps.io import read_dataset  # noqa: PLC0415  (xarray: a second)

    before, after = read_dataset(first), read_dataset(second)
    figure = str(after.attrs["figure"])
    if before["tau_align"].dims != after["tau_align"].dims:
        not_compared.append(f"{figure}: the two vary different parameters")
        return []
    if 0 in common_points(before, after)[1].sizes.values():
        not_compared.append(f"{figure}: the two have no point in common")
        return []
    return sorted(changes_of(before, after, figure), key=lambda each: each.variable)
