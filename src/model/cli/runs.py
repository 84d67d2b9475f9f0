"""``vibralign runs``: list the recorded runs and invocations of the study."""

import argparse
import re
from typing import Any

from model.cli.arguments import add_command, add_json, add_root, figure_name
from model.cli.tables import print_json, table
from model.events.outcomes import Outcome
from model.physics.parameters import PARAMETER_NAMES, check_name
from model.tracking.history import RUN_STATUS, Record, load_history, load_runs, select_runs

_OUTCOMES = tuple(
    dict.fromkeys([*RUN_STATUS, *(each.name.lower() for each in Outcome), "sensitive"])
)
_DATE = re.compile(r"\d{4}(-\d{2}(-\d{2}(T\d{2}(:\d{2}(:\d{2})?)?)?)?)?")
_LONGEST = 120  # characters of a reason in a list


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    words = "list the study's runs, failed and interrupted ones included"
    parser = add_command(commands, "runs", _runs, words, ", oldest first.")
    add_root(parser)
    add_json(parser)
    add = parser.add_argument
    add("--figure", metavar="FIG", help="only those of a figure, such as fig06 or 6")
    words = (
        "only those that hold this value or sweep over it, or, without =VALUE, that vary the "
        "parameter; may be repeated"
    )
    add("--parameter", action="append", default=[], metavar="NAME[=VALUE]", help=words)
    words = (
        f"only those with this status, or with a trajectory of this outcome: {', '.join(_OUTCOMES)}"
    )
    add("--outcome", metavar="OUTCOME", help=words)
    words = "only those started at DATE or later, UTC (2026, 2026-11, 2026-11-21T05:30)"
    add("--since", metavar="DATE", help=words)
    add("--until", metavar="DATE", help="only those started at DATE or earlier, DATE included")
    add("--current", action="store_true", help="only those whose results are in place")
    words = "list the invocations of Snakemake instead, by outcome and date if wanted"
    add("--invocations", action="store_true", help=words)


def _runs(arguments: argparse.Namespace) -> int:
    _check_conditions(arguments)
    if arguments.invocations:
        return _invocations(arguments)
    found = select_runs(
        load_runs(arguments.root),
        figure=arguments.figure and figure_name(arguments.figure),
        parameters=arguments.parameter,
        outcome=arguments.outcome,
        since=arguments.since,
        until=arguments.until,
        current=arguments.current,
    )
    if arguments.json:
        print_json(found)
        return 0
    print("\n".join(table([run_line(run) for run in found], _RUN_COLUMNS)))
    print(f"{len(found)} runs")
    return 0


def _check_conditions(arguments: argparse.Namespace) -> None:
    for condition in arguments.parameter:
        check_name(condition.partition("=")[0], PARAMETER_NAMES, "parameter")
    if arguments.outcome is not None:
        check_name(arguments.outcome, _OUTCOMES, "outcome")
    for option in ("since", "until"):
        text = getattr(arguments, option)
        if text is not None and not _DATE.fullmatch(text):
            raise ValueError(
                f"--{option} {text!r}: must be a date such as 2026-11 or 2026-11-21T05:30"
            )


_RUN_COLUMNS = (
    "started", "run", "status", "seconds", "trajectories", "aligned", "sensitive", "commit", "",
)  # fmt: skip


def run_line(run: Record) -> dict[str, Any]:
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
        "commit": commit_of(run),
        "": _shortened(run.get("reason", "" if run["current"] else "replaced since")),
    }


def _shortened(reason: str) -> str:
    """Return the beginning of a reason for a list; `show` and --json print all of it."""
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"


def _invocations(arguments: argparse.Namespace) -> int:
    for option in ("figure", "parameter", "current"):
        if getattr(arguments, option):
            raise ValueError(f"--{option}: is a condition on runs; leave out --invocations")
    history = select_runs(
        load_history(arguments.root),
        outcome=arguments.outcome,
        since=arguments.since,
        until=arguments.until,
    )
    if arguments.json:
        print_json(history)
        return 0
    columns = ("invocation", "outcome", "started", "seconds", "runs", "failed", "commit", "command",
               "")  # fmt: skip
    lines = [
        {
            "invocation": each["invocation"],
            "outcome": each["outcome"],
            "started": each["started"][:19],
            "seconds": each["wall_seconds"],
            "runs": len(each["runs"]),
            "failed": len(each["failures"]),
            "commit": commit_of(each),
            "command": " ".join(each["command"]),
            "": _shortened(each.get("reason", "")),
        }
        for each in history
    ]
    print("\n".join(table(lines, columns)))
    return 0


def commit_of(record: Record) -> str:
    """Return the beginning of the commit of a record, with + where there were changes."""
    git = record.get("git", {})
    return git.get("commit", "")[:8] + ("+" if git.get("dirty") else "")
