"""Write and read tables as CSV text; equal rows give equal bytes."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

Row = TypeVar("Row")


class TableError(ValueError):
    """A table that is missing, empty, or of another kind."""


def csv_text(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """Return a header and one line for each row.

    Raises:
        ValueError: a row with a key that is not in ``columns``.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_rows(path: Path, what: str, read: Callable[[dict[str, str]], Row]) -> list[Row]:
    """Read the rows of a table on disk.

    Args:
        path: the file.
        what: contents of the table, for the error message.
        read: makes a row from its text by column; KeyError, TypeError and ValueError refuse it.

    Raises:
        TableError: a file that is missing, empty, or not such a table.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
        if not rows:
            raise ValueError("it has no rows")  # noqa: TRY301 - reported with the others below
        return [read(row) for row in rows]
    except (OSError, UnicodeDecodeError, KeyError, ValueError, TypeError) as error:
        raise TableError(f"{path}: is not a table of {what} ({error}): build it again") from None
