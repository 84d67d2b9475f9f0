"""``vibralign runs``, ``show`` and ``diff``: what the study has recorded of itself."""

import argparse
import json
import re
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from model.cli.tables import cell, pairs, table
from model.events.outcomes import Outcome
from model.physics.parameters import PARAMETER_NAMES, check_name
from model.study.config import FIGURES
from model.tracking.comparison import Change, Comparison, compare
from model.tracking.history import find_invocation, load_history, select_invocations
from model.tracking.index import RUN_STATUS, find_run, load_runs, select_runs
from model.tracking.records import Record, TrackingError
from model.tracking.snapshot import snapshot

_OUTCOMES = tuple(
    dict.fromkeys([*RUN_STATUS, *(each.name.lower() for each in Outcome), "sensitive"])
)
_DATE = re.compile(r"\d{4}(-\d{2}(-\d{2}(T\d{2}(:\d{2}(:\d{2})?)?)?)?)?")
_LONGEST = 120  # characters of a reason in a list
_LISTED = 12  # lines of one section of `diff`; --all shows the rest


def add_commands(commands: Any) -> None:
    """Add the three commands to the parsers of ``vibralign``."""
    _add_runs(commands)
    _add_show(commands)
    _add_diff(commands)


def _parser(commands: Any, name: str, words: str, description: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(
        name, help=words, description=description, allow_abbrev=False
    )
    words = "results root whose history is meant (default: results)"
    parser.add_argument("--root", type=Path, default=Path("results"), metavar="DIR", help=words)
    parser.add_argument("--json", action="store_true", help="print everything as JSON")
    return parser


def _print_json(value: Any) -> None:
    print(json.dumps(value, indent=2, allow_nan=False))


# --- vibralign runs -----------------------------------------------------------------------------


def _add_runs(commands: Any) -> None:
    words = "list the study's runs, failed and interrupted ones included"
    parser = _parser(commands, "runs", words, f"{words[0].upper()}{words[1:]}, oldest first.")
    add = parser.add_argument
    add("--figure", metavar="FIG", help="only those of a figure, such as fig06 or 6")
    words = (
        "only those that hold or sweep over this value, or, without =VALUE, that vary the "
        "parameter; may be repeated"
    )
    add("--parameter", action="append", default=[], metavar="NAME[=VALUE]", help=words)
    words = f"only those that ended like this, or in which a trajectory did: {', '.join(_OUTCOMES)}"
    add("--outcome", metavar="OUTCOME", help=words)
    words = "only those started at DATE or later, UTC (2026, 2026-11, 2026-11-21T05:30)"
    add("--since", metavar="DATE", help=words)
    add("--until", metavar="DATE", help="only those started at DATE or earlier, DATE included")
    add("--current", action="store_true", help="only those whose results still stand")
    words = "list the invocations of Snakemake instead, by outcome and date if wanted"
    add("--invocations", action="store_true", help=words)
    parser.set_defaults(run=_runs)


def figure_name(text: str) -> str:
    """``fig06`` from fig06, 06 or 6.

    Raises:
        ValueError: no figure of the study.
    """
    name = f"fig{int(text):02}" if text.isdecimal() else text
    check_name(name, FIGURES, "figure")
    return name


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
        _print_json(found)
        return 0
    print("\n".join(table([_line(run) for run in found], _RUN_COLUMNS)))
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


def _line(run: Record) -> dict[str, Any]:
    counts = run.get("counts", {})
    return {
        "started": run["started"][:19],
        "run": run["run"],
        "status": run["status"],
        "seconds": run.get("wall_seconds"),
        "trajectories": counts.get("trajectories"),
        "aligned": counts.get("aligned"),
        "sensitive": counts.get("sensitive"),
        "commit": _commit(run),
        "": _shortened(run.get("reason", "" if run["current"] else "replaced since")),
    }


def _shortened(reason: str) -> str:
    """As much of a reason as fits a list; `show` and --json have it all."""
    return reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"


def _commit(record: Record) -> str:
    git = record.get("git", {})
    return git.get("commit", "")[:8] + ("+" if git.get("dirty") else "")


def _invocations(arguments: argparse.Namespace) -> int:
    for option in ("figure", "parameter", "current"):
        if getattr(arguments, option):
            raise ValueError(f"--{option}: is a condition on runs; leave out --invocations")
    history = select_invocations(
        load_history(arguments.root),
        outcome=arguments.outcome,
        since=arguments.since,
        until=arguments.until,
    )
    if arguments.json:
        _print_json(history)
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
            "commit": _commit(each),
            "command": " ".join(each["command"]),
            "": _shortened(each.get("reason", "")),
        }
        for each in history
    ]
    print("\n".join(table(lines, columns)))
    return 0


# --- vibralign show -----------------------------------------------------------------------------


def _add_show(commands: Any) -> None:
    words = "show all that is recorded of a run or an invocation"
    parser = _parser(commands, "show", words, f"{words[0].upper()}{words[1:]}.")
    words = (
        "a run such as merge/fig06 (the latest of that name), merge/fig06@INVOCATION, or an "
        "invocation: the beginning of its name, or last"
    )
    parser.add_argument("what", metavar="RUN", help=words)
    parser.set_defaults(run=_show)


def _show(arguments: argparse.Namespace) -> int:
    runs = load_runs(arguments.root)
    if arguments.what.partition("@")[0] in {run["run"] for run in runs}:
        record = find_run(runs, arguments.what)
        lines = _run_lines(record)
    else:
        try:
            record = find_invocation(load_history(arguments.root), arguments.what)
        except TrackingError:
            raise TrackingError(
                f"{arguments.what!r} is neither a run nor an invocation; vibralign runs lists them"
            ) from None
        lines = _invocation_lines(record)
    if arguments.json:
        _print_json(record)
    else:
        print("\n".join(lines))
    return 0


_HEAD = ("run", "status", "reason", "log", "current", "started", "wall_seconds", "invocation",
         "code", "sweep")  # fmt: skip


def _run_lines(run: Record) -> list[str]:
    head = {name: run[name] for name in _HEAD if run.get(name) not in (None, "")}
    lines = pairs({**head, "commit": _commit(run)})
    sections = {
        "counts": run.get("counts"),
        "parameters": run.get("parameters"),
        "varied": {
            axis["parameter"]: axis.get("values")
            or f"{cell(axis['start'])} to {cell(axis['stop'])}, {axis['count']} values"
            for axis in run.get("dimensions", [])
        },
        "settings": run.get("settings"),
        "inputs": run.get("inputs"),
        "outputs": run.get("outputs"),
        "versions": run.get("versions"),
    }
    for name, values in sections.items():
        if values:
            lines += ["", f"{name}:", *(f"  {line}" for line in pairs(values))]
    return lines


def _invocation_lines(record: Record) -> list[str]:
    head = ("invocation", "outcome", "reason", "started", "ended", "wall_seconds", "host",
            "snakemake_log")  # fmt: skip
    values = {name: record[name] for name in head if record.get(name) is not None}
    command = " ".join(record["command"])
    lines = pairs({**values, "command": command, "commit": _commit(record)})
    for failure in record["failures"]:
        lines += ["", f"{failure['run']} {failure['status']}: {failure['reason']}"]
        lines += [f"  {failure['log']}"]
    lines += ["", f"{len(record['runs'])} runs done"]
    columns = ("run", "seconds", "trajectories", "aligned", "sensitive")
    rows = [_line({**run, "status": "done", "current": True}) for run in record["runs"]]
    return lines + table(rows, columns) if rows else lines


# --- vibralign diff -----------------------------------------------------------------------------


def _add_diff(commands: Any) -> None:
    words = "say what differs between two runs, results folders or commits"
    parser = _parser(
        commands,
        "diff",
        words,
        "Say what differs: parameters, metrics, the largest change of every figure's variables, "
        "claims. Exit code: 0 nothing differs, 1 something does, 2 bad input.",
    )
    words = (
        "a results folder, a run (merge/fig06, merge/fig06@INVOCATION), an invocation, or a commit "
        "that the study was built at"
    )
    parser.add_argument("first", metavar="A", help=words)
    parser.add_argument("second", metavar="B", help="likewise")
    parser.add_argument("--all", action="store_true", help="every difference, however many")
    parser.set_defaults(run=_diff)


def _diff(arguments: argparse.Namespace) -> int:
    root = arguments.root
    found = compare(snapshot(arguments.first, root), snapshot(arguments.second, root))
    if arguments.json:
        _print_json(found.as_json)
    else:
        print("\n".join(diff_lines(found, None if arguments.all else _LISTED)))
    return int(found.differs)


def diff_lines(found: Comparison, listed: int | None) -> list[str]:
    """A comparison in words, at most ``listed`` lines a section."""
    lines = [f"A: {found.first}", f"B: {found.second}"]
    columns = ("where", "name", "before", "after")
    sections = {"parameters": found.parameters, "metrics": found.metrics, "code": found.code}
    if found.claims is not None:
        sections["claims"] = found.claims
    for title, differences in sections.items():
        lines += _section(title, [asdict(each) for each in differences], columns, listed)
    data = ("figure", "variable", "points", "differing", "largest", "at", "A", "B", "gaps")
    lines += _section("data", [_change(each) for each in found.data], data, listed)
    if found.other_data:
        lines += ["", "differ, no copies kept to say by how much:"]
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


def _change(change: Change) -> dict[str, Any]:
    gaps = f"+{change.appeared} -{change.vanished}" if change.appeared or change.vanished else ""
    return {
        "figure": change.figure,
        "variable": change.variable,
        "points": change.points,
        "differing": change.differing,
        "largest": f"{change.largest:.3g}",
        "at": change.at,
        "A": change.before,
        "B": change.after,
        "gaps": gaps,
    }
