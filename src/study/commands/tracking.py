"""``runs``, ``show`` and ``diff``: the recorded history of the study."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

import yaml

from model.physics.parameters import check_name
from study.commands.options import add_root, figure_name
from study.config import load_study, study_path
from study.tracking.compare import Comparison, compare
from study.tracking.history import STATUS, find, load_history, load_runs
from study.tracking.records import Record
from vibralign.commands.program import add_command, add_json
from vibralign.commands.tables import print_json, table

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
    add("--outcome", metavar="OUTCOME", help=f"only those with this status: {', '.join(STATUS)}")
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
        ": what was stated and counted, code, the largest change of every variable, claims.",
        epilog="exit code: 0 nothing differs; 1 something does; 2 bad input",
    )
    add_json(parser)
    parser.add_argument("first", type=Path, metavar="A", help="a results folder")
    parser.add_argument("second", type=Path, metavar="B", help="another, say of another checkout")
    parser.add_argument("--all", action="store_true", help="every difference, however many")


def _runs(arguments: argparse.Namespace) -> int:
    outcome, figure = arguments.outcome, arguments.figure
    if outcome is not None:
        check_name(outcome, STATUS, "outcome")
    if arguments.starts and figure:
        raise ValueError("--figure: selects runs, not starts; leave out --starts")
    if figure:
        figure = figure_name(figure, load_study(study_path()))
    records = (load_history if arguments.starts else load_runs)(arguments.root)
    found = [
        each
        for each in records
        if (not figure or each["figure"] == figure)
        and outcome in (None, each.get("status", each.get("outcome")))
    ]
    if arguments.json:
        print_json(found)
    elif arguments.starts:
        print("\n".join(table([_start_line(each) for each in found], _START_COLUMNS)))
    else:
        print("\n".join(table([_run_line(run) for run in found], _RUN_COLUMNS)))
        print(f"{len(found)} runs")
    return 0


_RUN_COLUMNS = (
    "started", "run", "status", "seconds", "trajectories", "aligned", "sensitive", "commit", "",
)  # fmt: skip
_START_COLUMNS = (
    "start", "outcome", "started", "seconds", "runs", "failed", "commit", "command", "",
)  # fmt: skip


def _run_line(run: Record) -> Record:
    """Return a run as a line of a table."""
    reason = run.get("reason", "" if run["current"] else "replaced since")
    return {**run, **run.get("counts", {}), **_common(run), "": _shortened(reason)}


def _start_line(record: Record) -> Record:
    return {
        **record,
        **_common(record),
        "runs": len(record["runs"]),
        "failed": len(record["failures"]),
        "command": " ".join(record["command"]),
        "": _shortened(record.get("reason", "")),
    }


def _common(record: Record) -> Record:
    """Return of a run or a start when it began, how long it took, and at which commit it was.

    Changes in the checkout are a + behind the commit.
    """
    git = record.get("git", {})
    return {
        "started": record["started"][:19],
        "seconds": record.get("wall_seconds"),
        "commit": git.get("commit", "")[:8] + ("+" if git.get("dirty") else ""),
    }


def _shortened(reason: str) -> str:
    """Return the beginning of a reason for a list; `show` and --json print all of it."""
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"


def _show(arguments: argparse.Namespace) -> int:
    record = shown = find(arguments.root, arguments.what)
    if "runs" in record:  # of a start
        done = {run["run"]: run.get("wall_seconds") for run in record["runs"]}
        shown = {**record, "study": None, "runs": done}
    if arguments.json:
        print_json(record)
    else:
        stated = {name: value for name, value in shown.items() if value not in (None, "", {}, [])}
        print(yaml.safe_dump(stated, sort_keys=False, allow_unicode=True, width=100), end="")
    return 0


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
    for title in ("stated", "code", "claims", "data"):
        rows = [asdict(each) for each in getattr(found, title) or ()]
        if not rows:
            lines += [] if getattr(found, title) is None else ["", f"{title}: the same"]
            continue
        drawn = table(rows[:listed], list(rows[0]))
        lines += ["", f"{title}: {len(rows)} differ", *(f"  {line}" for line in drawn)]
        if listed and listed < len(rows):
            lines.append(f"  … and {len(rows) - listed} more: --all shows them")
    for title, names in (
        ("files that differ", found.other_data),
        ("not compared", found.not_compared),
    ):
        lines += ["", f"{title}:", *(f"  {each}" for each in names)] if names else []
    return lines
