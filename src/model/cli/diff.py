"""``vibralign diff``: list the differences between two states of the study."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from model.cli.arguments import add_command, add_json, add_root
from model.cli.tables import print_json, table
from model.tracking.compare import Change
from model.tracking.diff import Comparison, compare, snapshot

_LISTED = 12  # lines of a section; --all shows the rest


def add(commands: Any) -> None:
    """Add the command to the parsers of ``vibralign``."""
    parser = add_command(
        commands,
        "diff",
        _diff,
        "list the differences between two runs, results folders or commits",
        ": parameters, metrics, the largest change of every figure's variables, claims.",
        epilog="exit code: 0 nothing differs; 1 something does; 2 bad input",
    )
    add_root(parser)
    add_json(parser)
    words = (
        "a results folder, a run (merge/fig06, merge/fig06@INVOCATION), an invocation, or a commit "
        "that the study was built at"
    )
    parser.add_argument("first", metavar="A", help=words)
    parser.add_argument("second", metavar="B", help="likewise")
    parser.add_argument("--all", action="store_true", help="every difference, however many")


def _diff(arguments: argparse.Namespace) -> int:
    root = arguments.root
    found = compare(snapshot(arguments.first, root), snapshot(arguments.second, root))
    if arguments.json:
        print_json(asdict(found))
    else:
        print("\n".join(diff_lines(found, None if arguments.all else _LISTED)))
    return int(found.differs)


def diff_lines(found: Comparison, listed: int | None) -> list[str]:
    """Return a comparison in words, at most ``listed`` lines a section."""
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
