"""Write and read tables as CSV text; equal rows give equal bytes."""

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, fields
from enum import Enum, IntEnum
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


# --- Dataclasses as rows ------------------------------------------------------------------------


def records_text(
    kind: type[Any], records: Iterable[Any], formats: Mapping[str, str], without: str = ""
) -> str:
    """Return records of one ``kind`` as CSV: values by ``formats``, one column left out."""
    names = [field.name for field in fields(kind) if field.name != without]

    def written(record: Any, name: str) -> Any:
        value = getattr(record, name)
        if isinstance(value, IntEnum):
            return value.name.lower()
        return value.value if isinstance(value, Enum) else format(value, formats.get(name, ""))

    return csv_text(names, ({name: written(each, name) for name in names} for each in records))


def read_records(path: Path, what: str, kind: type[Row]) -> list[Row]:
    """Return the records that ``records_text`` wrote; a field without a column takes its default.

    Raises:
        TableError: a file that is missing or not such a table.
    """

    def value(text: str, of: Any) -> Any:
        return of[text.upper()] if issubclass(of, IntEnum) else of(text)

    def read(row: dict[str, str]) -> Row:
        given = [
            field
            for field in fields(kind)  # type: ignore[arg-type]
            if field.name in row or field.default is MISSING
        ]
        return kind(**{field.name: value(row[field.name], field.type) for field in given})

    return read_rows(path, what, read)
