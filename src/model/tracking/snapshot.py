"""States of the study: a results folder, or an earlier state kept in the history."""

import os
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from model.tracking import TrackingError
from model.tracking.history import (
    Record,
    find_invocation,
    kept_outputs,
    kept_result,
    load_history,
    sidecars,
)
from model.tracking.runs import find_run, load_runs

CLAIMS = "claims.csv"


@dataclass(frozen=True)
class Snapshot:
    """The study at one moment.

    Attributes:
        label: name given by the user.
        runs: latest run of each name.
        files: paths of the datasets ("fig06.nc") and of the claims' verdicts, by name.
        lost: names of files without a kept copy.
    """

    label: str
    runs: Mapping[str, Record]
    files: Mapping[str, Path]
    lost: tuple[str, ...] = ()

    def newer_than_claims(self) -> list[str]:
        """Return the files that have changed since the claims were judged."""
        made = {
            _place(run, name): sha256
            for run in self.runs.values()
            for name, sha256 in run["outputs"].items()
        }
        judged = [run for run in self.runs.values() if CLAIMS in run["outputs"]]
        read = {_place(run, name): sha for run in judged for name, sha in run["inputs"].items()}
        return sorted(name for name, sha256 in read.items() if made.get(name, sha256) != sha256)


def _place(run: Record, name: str) -> str:
    """Return the path below the results root of a file that ``run`` names from its folder."""
    return os.path.normpath(Path(run["folder"], name))


def snapshot(name: str, root: Path) -> Snapshot:
    """Return the state of the study that ``name`` denotes.

    Args:
        name: a folder of results; or, of the history below ``root``, a run ("merge/fig06" or
            "merge/fig06@INVOCATION"), an invocation ("last", or the beginning of its name), or a
            commit that the study was built at (any name that git knows).
        root: results root with the history.

    Raises:
        TrackingError: a name without a record.
    """
    if Path(name).is_dir():
        return _of_folder(Path(name))
    history, runs = load_history(root), load_runs(root)
    if name.partition("@")[0] in {run["run"] for run in runs}:
        run = find_run([run for run in runs if run["status"] == "done"], name)
        return _of_runs(name, [run], root)
    named = [each for each in history if each["invocation"].startswith(name)]
    if name == "last" or named:
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
    files, lost = {}, []
    for run in latest.values():
        for name, sha256 in kept_outputs(run).items():
            kept = kept_result(root, name, sha256)
            if kept.is_file():
                files[name] = kept
            else:
                lost.append(name)
    return Snapshot(label, latest, files, tuple(lost))


def _invocation_of_commit(history: Sequence[Record], name: str, root: Path) -> Record:
    git = subprocess.run(
        ["git", "rev-parse", "--verify", "--quiet", f"{name}^{{commit}}"],
        capture_output=True,
        text=True,
        check=False,
    )
    commit = git.stdout.strip() or name
    built = [
        each
        for each in history
        if each["git"].get("commit", "").startswith(commit)
        and (each["runs"] or each["outcome"] == "done")  # not what was refused
    ]
    if built:
        return built[-1]
    raise TrackingError(
        f"{name!r} is no results folder, and neither a run, an invocation nor a commit in "
        f"{root / 'history'}; to compare with another commit, build it in a checkout of its own "
        "(git worktree add) and name its results folder"
    )
