"""Tables and JSON for a terminal.

They replace rich and tabulate, which cut or wrap cells to the width of the terminal.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

report_line = "{:<16}{}".format  # of a label and words


def table(rows: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> list[str]:
    """Return the lines of a table with a heading; a row may lack a column.

    Columns of numbers are set to the right, others to the left.
    """
    lines = [list(columns)] + [[cell(row.get(name)) for name in columns] for row in rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(columns))]
    numeric = [all(_is_number(row.get(name)) for row in rows) for name in columns]
    return [
        "  ".join(
            text.rjust(width) if right else text.ljust(width)
            for text, width, right in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in lines
    ]


def cell(value: Any) -> str:
    """Return a value as a table shows it, the empty string for None."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {cell(item)}" for name, item in value.items())
    if isinstance(value, (list, tuple)):
        return ", ".join(cell(item) for item in value)
    return str(value)


def _is_number(value: Any) -> bool:
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def in_columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Return the indented lines of a table without a heading."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


def print_json(value: Any) -> None:
    """Print a value as JSON, numbers that are not finite as null."""
    print(json.dumps(or_null(value), indent=2, ensure_ascii=False, allow_nan=False))


def or_null(value: Any) -> Any:
    """Return the value, nested or not, with None in place of numbers that are not finite."""
    if isinstance(value, Mapping):
        return {name: or_null(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [or_null(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
