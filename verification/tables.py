"""Tables of records: dataclasses as rows of CSV, written and read by their fields."""

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, fields
from enum import Enum, IntEnum
from pathlib import Path
from typing import Any, TypeVar

from model.study.csv_tables import csv_text, read_rows

Record = TypeVar("Record")


def table_text(
    records: Sequence[Any], kind: type[Any], formats: Mapping[str, str], without: str = ""
) -> str:
    """Return records of one ``kind`` as CSV: numbers by ``formats``, one column left out."""
    names = [field.name for field in fields(kind) if field.name != without]
    return csv_text(
        names,
        (
            {name: _written(getattr(record, name), formats.get(name, "")) for name in names}
            for record in records
        ),
    )


def _written(value: Any, spec: str) -> Any:
    if isinstance(value, IntEnum):
        return value.name.lower()
    return value.value if isinstance(value, Enum) else format(value, spec)


def read_table(path: Path, what: str, kind: type[Record]) -> list[Record]:
    """Return the records that ``table_text`` wrote; a field without a column takes its default.

    Raises:
        TableError: a file that is missing or not such a table.
    """

    def read(row: dict[str, str]) -> Record:
        given = [
            field
            for field in fields(kind)  # type: ignore[arg-type]
            if field.name in row or field.default is MISSING
        ]
        return kind(**{field.name: _read(row[field.name], field.type) for field in given})

    return read_rows(path, what, read)


def _read(text: str, kind: Any) -> Any:
    return kind[text.upper()] if issubclass(kind, IntEnum) else kind(text)
