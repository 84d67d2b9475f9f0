"""Index of all recorded runs: status, whether results are current, and selection."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from model.study.csv_tables import csv_text
from model.study.files import write_text
from model.tracking import TrackingError
from model.tracking.history import Record, load_history, sidecars, within

RUN_STATUS = ("done", "failed", "interrupted")
COUNTS = (
    "trajectories", "aligned", "settled", "left_scene", "horizon_reached", "failed", "sensitive",
    "rhs_evaluations",
)  # fmt: skip
COLUMNS = (
    "run", "rule", "figure", "status", "current", "started", "wall_seconds", "invocation", "commit",
    "dirty", "code", "config_hash", "outputs", *(f"runs_{name}" for name in COUNTS), "host",
    "reason",
)  # fmt: skip


def load_runs(root: Path) -> list[Record]:
    """Return every run ever recorded below a results root, oldest first.

    Each is a sidecar with ``status`` (one of RUN_STATUS), ``current`` (True if its results are in
    place, or for a failure if no later run succeeded) and, for a failure, ``reason``.

    Raises:
        TrackingError: as ``load_history``.
    """
    standing = {_identity(record): record for record in sidecars(root).values()}
    runs = {key: {**record, "status": "done"} for key, record in standing.items()}
    for invocation in load_history(root):
        for record in invocation["runs"]:
            runs.setdefault(_identity(record), {**record, "status": "done"})
        for record in invocation["failures"]:
            stated = {"invocation": invocation["invocation"], "git": invocation["git"]}
            runs[_identity(record)] = {**stated, **record}
    whole = {run for run, _ in standing}
    latest_failure = {run: key for key, each in runs.items() for run in [each["run"]]
                      if each["status"] != "done"}  # fmt: skip
    for key, record in runs.items():
        if record["status"] == "done":
            record["current"] = key in standing
        else:
            record["current"] = record["run"] not in whole and latest_failure[record["run"]] == key
    return sorted(runs.values(), key=lambda each: (each["started"], each["run"]))


def _identity(record: Record) -> tuple[str, str]:
    return record["run"], record["started"]


def find_run(runs: Sequence[Record], name: str) -> Record:
    """Return the latest run of that name; "NAME@INVOCATION" the one of that invocation.

    Raises:
        TrackingError: no run of that name.
    """
    run, _, invocation = name.partition("@")
    found = [
        each
        for each in runs
        if each["run"] == run and str(each.get("invocation", "")).startswith(invocation)
    ]
    if not found:
        raise TrackingError(f"{name!r} is no run; vibralign runs lists them")
    return found[-1]


def select_runs(
    runs: Iterable[Record],
    *,
    figure: str | None = None,
    parameters: Sequence[str] = (),
    outcome: str | None = None,
    since: str | None = None,
    until: str | None = None,
    current: bool = False,
) -> list[Record]:
    """Return the runs that fit every condition given.

    Args:
        runs: as from ``load_runs``.
        figure: such as "fig06".
        parameters: "NAME=VALUE" for runs that hold or sweep over the value, "NAME" for runs that
            vary the parameter.
        outcome: a status (done, failed, interrupted), or an outcome of at least one of the run's
            trajectories (aligned, settled, left_scene, horizon_reached, failed, sensitive).
        since: first moment, as ISO 8601 with as many parts as wanted ("2026-11").
        until: last moment, likewise.
        current: only runs whose results are in place.
    """
    return [
        run
        for run in runs
        if (figure is None or run["figure"] == figure)
        and all(_covers(run, condition) for condition in parameters)
        and (outcome is None or _has_outcome(run, outcome))
        and within(run, since, until)
        and (not current or run["current"])
    ]


def _has_outcome(run: Record, outcome: str) -> bool:
    return bool(run["status"] == outcome or run.get("counts", {}).get(outcome, 0))


def _covers(run: Record, condition: str) -> bool:
    name, equals, text = condition.partition("=")
    axis = next((each for each in run.get("dimensions", []) if each["parameter"] == name), None)
    if not equals:
        return axis is not None
    try:
        value = float(text)
    except ValueError:
        raise TrackingError(f"{condition!r}: {text!r} is no number") from None
    if axis is None:
        return bool(run.get("parameters", {}).get(name) == value)
    values = axis.get("values") or (axis["start"], axis["stop"])
    return bool(min(values) <= value <= max(values))


def _row(run: Record) -> Record:
    """Return a run as one line of the index."""
    counts, git = run.get("counts", {}), run.get("git", {})
    flat = {
        **run,
        "current": int(run["current"]),
        "commit": git.get("commit"),
        "dirty": int(git["dirty"]) if "dirty" in git else None,
        "outputs": " ".join(f"{name}:{sha}" for name, sha in run.get("outputs", {}).items()),
        **{f"runs_{name}": counts.get(name) for name in COUNTS},
    }
    return {column: flat.get(column) for column in COLUMNS}


def write_index(root: Path) -> None:
    """Write runs.csv, whole or not at all.

    Raises:
        TrackingError: as ``load_runs``.
        OSError: the folder cannot be written.
    """
    rows = (_row(run) for run in load_runs(root))
    write_text(csv_text(COLUMNS, rows), root / "runs.csv")
