"""``runs``, ``show`` and ``diff``: the recorded history of the study."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import yaml

from model.events.outcomes import Outcome
from model.physics.parameters import check_name
from study.commands.options import add_root, figure_name
from study.config import load_study, study_path
from study.tracking import TrackingError
from study.tracking.compare import Change, Comparison, compare
from study.tracking.history import (
    RUN_STATUS,
    find_run,
    find_start,
    has_outcome,
    load_history,
    load_runs,
)
from study.tracking.records import Record
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json, table

_OUTCOMES = tuple(
    dict.fromkeys([*RUN_STATUS, *(each.name.lower() for each in Outcome), "sensitive"])
)
_LONGEST = 120  # characters of a reason in a list
_LISTED = 12  # lines of a section of differences; --all shows the rest


def add(commands: Any) -> None:
    """Add the commands to the parsers of the study."""
    words = "list the study's runs, failed and interrupted ones included"
    parser = add_command(commands, "runs", _runs, words, ", oldest first.")
    add_root(parser)
    add_json(parser)
    add = parser.add_argument
    add("--figure", metavar="FIG", help="only those of a figure, such as fig06 or 6")
    words = (
        f"only those with this status, or with a trajectory of this outcome: {', '.join(_OUTCOMES)}"
    )
    add("--outcome", metavar="OUTCOME", help=words)
    words = "list the starts of the study instead of its runs; --outcome selects some"
    add("--starts", action="store_true", help=words)

    words = "show all that is recorded of a run or a start"
    parser = add_command(commands, "show", _show, words)
    add_root(parser)
    add_json(parser)
    words = (
        "a run such as merge/fig06 (the latest of that name), merge/fig06@12 (that of start 12), "
        "or a start: its number, or last"
    )
    parser.add_argument("what", metavar="RUN", help=words)

    parser = add_command(
        commands,
        "diff",
        _diff,
        "list the differences between two results folders",
        ": parameters, metrics, the largest change of every figure's variables, claims.",
        epilog="exit code: 0 nothing differs; 1 something does; 2 bad input",
    )
    add_json(parser)
    parser.add_argument("first", type=Path, metavar="A", help="a results folder")
    parser.add_argument("second", type=Path, metavar="B", help="another, say of another checkout")
    parser.add_argument("--all", action="store_true", help="every difference, however many")


def _runs(arguments: argparse.Namespace) -> int:
    outcome, figure = arguments.outcome, arguments.figure and _figure(arguments.figure)
    if outcome is not None:
        check_name(outcome, _OUTCOMES, "outcome")
    if arguments.starts and figure:
        raise ValueError("--figure: selects runs, not starts; leave out --starts")
    records = (load_history if arguments.starts else load_runs)(arguments.root)
    found = [
        each
        for each in records
        if (not figure or each["figure"] == figure)
        and (outcome is None or has_outcome(each, outcome))
    ]
    if arguments.json:
        print_json(found)
        return 0
    if arguments.starts:
        print("\n".join(table([_start_line(each) for each in found], _START_COLUMNS)))
        return 0
    print("\n".join(table([_run_line(run) for run in found], _RUN_COLUMNS)))
    print(f"{len(found)} runs")
    return 0


def _figure(text: str) -> str:
    return figure_name(text, load_study(study_path()))


_RUN_COLUMNS = (
    "started", "run", "status", "seconds", "trajectories", "aligned", "sensitive", "commit", "",
)  # fmt: skip
_START_COLUMNS = (
    "start", "outcome", "started", "seconds", "runs", "failed", "commit", "command", "",
)  # fmt: skip


def _run_line(run: Record) -> dict[str, Any]:
    """Return a run as a line of a table."""
    counts = run.get("counts", {})
    return {
        "started": run["started"][:19],
        "run": run["run"],
        "status": run["status"],
        "seconds": run.get("wall_seconds"),
        "trajectories": counts.get("trajectories"),
        "aligned": counts.get("aligned"),
        "sensitive": counts.get("sensitive"),
        "commit": _commit_of(run),
        "": _shortened(run.get("reason", "" if run["current"] else "replaced since")),
    }


def _shortened(reason: str) -> str:
    """Return the beginning of a reason for a list; `show` and --json print all of it."""
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"


def _start_line(record: Record) -> dict[str, Any]:
    return {
        "start": record["start"],
        "outcome": record["outcome"],
        "started": record["started"][:19],
        "seconds": record["wall_seconds"],
        "runs": len(record["runs"]),
        "failed": len(record["failures"]),
        "commit": _commit_of(record),
        "command": " ".join(record["command"]),
        "": _shortened(record.get("reason", "")),
    }


def _commit_of(record: Record) -> str:
    """Return the beginning of the commit of a record, with + where there were changes."""
    git = record.get("git", {})
    return git.get("commit", "")[:8] + ("+" if git.get("dirty") else "")


def _show(arguments: argparse.Namespace) -> int:
    runs = load_runs(arguments.root)
    if arguments.what.partition("@")[0] in {run["run"] for run in runs}:
        record = find_run(runs, arguments.what)
        lines = _lines(record)
    else:
        try:
            record = find_start(load_history(arguments.root), arguments.what)
        except TrackingError:
            raise TrackingError(
                f"{arguments.what!r} is neither a run nor a start; python -m study runs lists them"
            ) from None
        lines = _start_lines(record)
    if arguments.json:
        print_json(record)
    else:
        print("\n".join(lines))
    return 0


def _lines(record: Record) -> list[str]:
    """Return all of a record as YAML, without what it has no value for."""
    stated = {name: value for name, value in record.items() if value not in (None, "", {}, [])}
    return yaml.safe_dump(stated, sort_keys=False, allow_unicode=True, width=100).splitlines()


def _start_lines(record: Record) -> list[str]:
    """Return the record of a start; of its runs a line each."""
    lines = _lines({name: record[name] for name in record if name not in ("runs", "study")})
    lines += ["", f"{len(record['runs'])} runs done"]
    columns = ("run", "seconds", "trajectories", "aligned", "sensitive")
    rows = [_run_line({**run, "status": "done", "current": True}) for run in record["runs"]]
    return lines + table(rows, columns) if rows else lines


def _diff(arguments: argparse.Namespace) -> int:
    found = compare(arguments.first, arguments.second)
    if arguments.json:
        print_json(asdict(found))
    else:
        print("\n".join(_diff_lines(found, None if arguments.all else _LISTED)))
    return int(found.differs)


def _diff_lines(found: Comparison, listed: int | None) -> list[str]:
    """Return a comparison in words, at most ``listed`` lines a section."""
    lines = [f"A: {found.first}", f"B: {found.second}"]
    columns = ("where", "name", "before", "after")
    for title in ("parameters", "metrics", "code", "claims"):
        differences = getattr(found, title)
        if differences is not None:
            lines += _section(title, [asdict(each) for each in differences], columns, listed)
    data = tuple(each.name for each in fields(Change))
    lines += _section("data", [asdict(each) for each in found.data], data, listed)
    if found.other_data:
        lines += ["", "files that differ:"]
        lines += [f"  {each}" for each in found.other_data]
    if found.not_compared:
        lines += ["", "not compared:", *(f"  {each}" for each in found.not_compared)]
    return lines


def _section(
    title: str, rows: Sequence[dict[str, Any]], columns: Sequence[str], listed: int | None
) -> list[str]:
    if not rows:
        return ["", f"{title}: the same"]
    shown = rows[:listed]
    lines = ["", f"{title}: {len(rows)} differ", *(f"  {line}" for line in table(shown, columns))]
    if len(shown) < len(rows):
        lines.append(f"  … and {len(rows) - len(shown)} more: --all shows them")
    return lines
