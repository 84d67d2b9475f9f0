"""Tables as CSV text: the same rows give the same bytes."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

Row = TypeVar("Row")


class TableError(ValueError):
    """A table that is not what it should be: missing, empty, or of something else."""


def csv_text(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """A header and one line for each row.

    Raises:
        ValueError: a row that holds something besides ``columns``.
    """
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_rows(path: Path, what: str, read: Callable[[dict[str, str]], Row]) -> list[Row]:
    """The rows of a table on disk, each as ``read`` makes it of its text by column.

    Args:
        path: the file.
        what: what it is a table of, for the error.
        read: may raise KeyError, TypeError or ValueError for a row that is not of such a table.

    Raises:
        TableError: a file that is missing, empty, or not such a table.
    """
    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
        if not rows:
            raise ValueError("it has no rows")  # noqa: TRY301 - told with the others below
        return [read(row) for row in rows]
    except (OSError, UnicodeDecodeError, KeyError, ValueError, TypeError) as error:
        raise TableError(f"{path}: is not a table of {what} ({error}): build it again") from None
