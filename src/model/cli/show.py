"""``vibralign show``: show the record of a run or an invocation."""

import argparse
from typing import Any

from model.cli.arguments import add_command, add_json, add_root
from model.cli.runs import commit_of, run_line
from model.cli.tables import cell, pairs, print_json, table
from model.tracking import TrackingError
from model.tracking.history import Record, find_invocation, find_run, load_history, load_runs


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    words = "show all that is recorded of a run or an invocation"
    parser = add_command(commands, "show", _show, words)
    add_root(parser)
    add_json(parser)
    words = (
        "a run such as merge/fig06 (the latest of that name), merge/fig06@INVOCATION, or an "
        "invocation: the beginning of its name, or last"
    )
    parser.add_argument("what", metavar="RUN", help=words)


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
        print_json(record)
    else:
        print("\n".join(lines))
    return 0


_HEAD = ("run", "status", "reason", "log", "current", "started", "wall_seconds", "invocation",
         "code", "config_hash")  # fmt: skip


def _run_lines(run: Record) -> list[str]:
    head = {name: run[name] for name in _HEAD if run.get(name) not in (None, "")}
    lines = pairs({**head, "commit": commit_of(run)})
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
    lines = pairs({**values, "command": command, "commit": commit_of(record)})
    for failure in record["failures"]:
        lines += ["", f"{failure['run']} {failure['status']}: {failure['reason']}"]
        lines += [f"  {failure['log']}"]
    lines += ["", f"{len(record['runs'])} runs done"]
    columns = ("run", "seconds", "trajectories", "aligned", "sensitive")
    rows = [run_line({**run, "status": "done", "current": True}) for run in record["runs"]]
    return lines + table(rows, columns) if rows else lines
