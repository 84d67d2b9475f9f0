"""Write and read dataclass records as CSV tables; equal rows give equal bytes."""

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from enum import IntEnum
from pathlib import Path
from typing import Any, TypeVar

Row = TypeVar("Row")


def records_text(
    kind: type[Any], records: Iterable[Any], formats: Mapping[str, str], without: str = ""
) -> str:
    """Return dataclass records as CSV.

    Args:
        kind: the dataclass; its fields are the columns.
        records: the rows.
        formats: format specifications by field.
        without: a field to leave out.
    """
    names = [field.name for field in fields(kind) if field.name != without]

    def written(record: Any, name: str) -> Any:
        value = getattr(record, name)
        is_named = isinstance(value, IntEnum)
        return value.name.lower() if is_named else format(value, formats.get(name, ""))

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([names, *([written(each, name) for name in names] for each in records)])
    return text.getvalue()


def read_records(path: Path, what: str, kind: type[Row]) -> list[Row]:
    """Return the records of a file that ``records_text`` made; missing columns take defaults.

    Raises:
        ValueError: the file is missing or no such table.
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

    try:
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
        if not rows:
            raise ValueError("it has no rows")  # noqa: TRY301 - reported with the others below
        return [read(row) for row in rows]
    except (OSError, KeyError, ValueError, TypeError, csv.Error) as error:
        raise ValueError(f"{path}: is not a table of {what} ({error}): build it again") from None
