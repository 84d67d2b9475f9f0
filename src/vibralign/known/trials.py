"""Tables of trials, as a spreadsheet saves them: a column for each quantity that was set.

The column ``result`` holds the alignment time (91.6 ms, or 91.6 ± 5 ms), ``fails``, ``fails after
2 s``, or ``> 500 ms`` where somebody stopped it. A blank cell is as in the device file. Units stand
in cells or in heads (press_force [N]). Every refusal names the row, as the spreadsheet counts it.
"""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from model.physics.tables import Value
from model.sweeps.files import read_text
from vibralign.device import StatedDevice
from vibralign.device.amounts import read_amount, read_positive
from vibralign.device.plausibility import DISTRUSTED
from vibralign.device.quantities import unit_of
from vibralign.device.spelling import plain

RESULT, NOTE = "result", "note"
ERROR = 0.05  # relative error of a time whose error is not stated
FEWEST = 2  # trials

_HEAD = re.compile(r"\s*([^\[(]+?)\s*(?:[\[(]\s*(.*?)\s*[\])])?\s*")
_FAILS = re.compile(
    r"(?i)\s*(?:fails?|failed|jams?|jammed|no)(?:\s+(?:after|within|in)\s+(.+))?\s*"
)
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_POINT = re.compile(r"\d\.\d")


@dataclass(frozen=True, eq=False, repr=False)
class Trial(Value):
    """One trial; SI units.

    Attributes:
        row: row of the table, as a spreadsheet counts it.
        device: the device as it was set; its tolerances are those of the touch-down.
        time: alignment time in s, or None if it failed or was stopped.
        error: relative error of the time, one standard deviation.
        waited: time in s after which it failed or was stopped; None for the horizon or a time.
        setting: what was set, as the table has it.
        result: the result, as the table has it.
    """

    row: int
    device: StatedDevice
    time: float | None
    error: float
    waited: float | None
    setting: Mapping[str, str]
    result: str

    @property
    def words(self) -> str:
        """The setting and the result in words."""
        own = ", ".join(f"{name} = {text}" for name, text in self.setting.items())
        return f"row {self.row} ({own or 'as in the device file'}; {self.result})"


def read_trials(device: StatedDevice, table: Any) -> list[Trial]:
    """Return the trials of a table: the path of a CSV file, a DataFrame, or rows by column.

    Raises:
        ValueError: a column that is no quantity, a cell that cannot be read, a trial that cannot
            be modelled, or fewer than two trials; with the row and the cell.
    """
    if isinstance(table, (str, Path)):
        source, heads, rows = _of_file(Path(table))
        top = "row 1"
    else:
        source, top = "trials", "columns"
        records = table.to_dict("records") if hasattr(table, "to_dict") else list(table)
        heads = list(dict.fromkeys(head for each in records for head in each))
        rows = [
            (i + 1, [_text(each.get(head)) for head in heads]) for i, each in enumerate(records)
        ]
    with _naming(source):
        with _naming(top):
            columns = _columns(heads, device)
        trials = [_trial(device, columns, *row) for row in rows if any(row[1])]
    if len(trials) < FEWEST:
        raise ValueError(f"{source}: has {len(trials)} trials: needs at least {FEWEST}")
    return trials


@contextmanager
def _naming(place: str) -> Iterator[None]:
    """Refuse with the place in front."""
    try:
        yield
    except ValueError as refusal:
        raise ValueError(f"{place}: {refusal}") from None


def _columns(heads: Sequence[str], device: StatedDevice) -> list[tuple[str, str]]:
    """Return the names of the columns and the units of their heads."""
    columns = [_column(head, device) for head in heads]
    names = [name for name, _ in columns]
    if RESULT not in names:
        raise ValueError(f"has no column `{RESULT}`: its columns are {', '.join(names) or 'none'}")
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"has two columns `{name}`: leave one out")
    return columns


def _text(cell: Any) -> str:
    return "" if cell is None or cell != cell else str(cell).strip()  # noqa: PLR0124  (NaN)


def _of_file(path: Path) -> tuple[str, list[str], list[tuple[int, list[str]]]]:
    """Return the heads of a CSV file, and its rows with their numbers."""
    try:
        text = read_text(path).removeprefix("\ufeff")
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    first = text.partition("\n")[0]
    if not first.strip():
        raise ValueError(f"{path}: is empty: the first line has the columns")
    mark = max(";\t,", key=first.count)
    lines = [
        [cell.strip() for cell in row] for row in csv.reader(io.StringIO(text), delimiter=mark)
    ]
    heads, rows = lines[0], [(i + 1, row) for i, row in enumerate(lines) if i and any(row)]
    for number, row in rows:
        if len(row) > len(heads) and any(row[len(heads) :]):
            raise ValueError(
                f"{path}: row {number} has {len(row)} cells under {len(heads)} heads: a decimal "
                "comma splits a cell; save the table with semicolons, or write decimal points"
            )
    cells = [cell for _, row in rows for cell in row]
    if any(map(_COMMA.search, cells)):
        if mark == ",":
            _refuse_comma(path, rows)
        if any(map(_POINT.search, cells)):
            raise ValueError(f"{path}: has decimal commas and decimal points: write one kind")
        rows = [(number, [_COMMA.sub(".", cell) for cell in row]) for number, row in rows]
    return str(path), heads, [(n, row + [""] * (len(heads) - len(row))) for n, row in rows]


def _refuse_comma(path: Path, rows: Iterable[tuple[int, Sequence[str]]]) -> None:
    number, cell = next((n, c) for n, row in rows for c in row if _COMMA.search(c))
    raise ValueError(
        f"{path}: row {number}: {cell!r}: a comma separates the cells of this table: write a "
        "decimal point, or save it with semicolons"
    )


def _column(head: str, device: StatedDevice) -> tuple[str, str]:
    """Return the name of a column and the unit of its head, "" without."""
    match = _HEAD.fullmatch(str(head))
    if match is None:
        raise ValueError(f"a column head has no name: {head!r}")
    name, unit = match[1], match[2] or ""
    if name in (NOTE, "vibrator"):
        return name, unit
    try:
        own = "s" if name == RESULT else unit_of(name)
    except ValueError as error:
        raise ValueError(f"{error}; head a column of remarks `{NOTE}`") from None
    if name in device.unknown:
        raise ValueError(
            f"column `{name}`: is unknown in {device.source}, and a trial sets it: leave it out of "
            "one"
        )
    try:
        read_amount(name, f"1 {unit}", own, device.quantities["frequency"])
    except ValueError as error:
        words = str(error).partition(": ")[2]
        raise ValueError(f"column head {str(head)!r}: {words}") from None
    return name, unit


def _trial(
    device: StatedDevice, columns: Sequence[tuple[str, str]], row: int, cells: Sequence[str]
) -> Trial:
    with _naming(f"row {row}"):
        given = {}
        for (name, unit), cell in zip(columns, cells, strict=True):
            if name != NOTE and cell:
                given[name] = f"{cell} {unit}" if unit and _is_number(cell) else cell
        result = given.pop(RESULT, "")
        time, error, waited = _result(result)
        own = device.changed(**given)
        own.admitted({})
    return Trial(row, own, time, error, waited, given, result)


def _is_number(cell: str) -> bool:
    """Return whether a cell has no unit of its own: it gets that of the head."""
    bare = re.sub(r"(?i)fail(s|ed)? (after|within|in)|σ", "", plain(cell))
    return bool(re.search(r"\d", bare)) and not re.search(r"[^\W\d_eE]|%|°", bare)


def _result(text: str) -> tuple[float | None, float, float | None]:
    """Return time, relative error and waiting time of a result."""
    if not text:
        raise ValueError(f"{RESULT} is blank: write the alignment time, or fails")
    if match := _FAILS.fullmatch(text):
        return None, ERROR, read_positive(RESULT, match[1], "s") if match[1] else None
    if text.startswith((">", "≥")):
        return None, ERROR, read_positive(RESULT, text.lstrip(">≥= "), "s")
    if not re.search(r"[^\W\d_eE]", plain(text)):
        raise ValueError(
            f"{RESULT} = {text!r}: has no unit; write {text} ms, or head the column `{RESULT} [ms]`"
        )
    try:
        amount = read_amount(RESULT, text, "s")
    except ValueError as error:
        raise ValueError(f"{error}; or fails, fails after 2 s, > 500 ms") from None
    if not 0.0 < amount.value < float("inf"):
        raise ValueError(f"{RESULT} = {text!r}: must be a finite time > 0")
    if amount.tolerance is None:
        return amount.value, ERROR, None
    return amount.value, amount.tolerance.around(amount.value) / amount.value, None


def notes_on(trials: Sequence[Trial], unknown: int) -> list[str]:
    """Return words on trials that can tell little."""
    notes = []
    if len(trials) <= unknown:
        notes.append(f"{len(trials)} trials for {unknown} unknowns: they can tell little")
    if len({tuple(sorted(each.setting.items())) for each in trials}) == 1:
        notes.append("all trials have one setting: they tell little of the unknowns")
    if all(each.time is None for each in trials):
        notes.append("all trials fail: they tell where it fails, but no time")
    return notes


def distrusted(trials: Sequence[Trial], unknowns: Mapping[str, float]) -> list[str]:
    """Return words on trials for which the model may not hold at these values of the unknowns."""
    notes = [
        f"{each.words}: {doubt}"
        for each in trials
        for doubt in each.device.changed(**unknowns).doubts
        if DISTRUSTED in doubt
    ]
    more = [f"the same holds for {len(notes) - 1} more trials"] if len(notes) > 1 else []
    return [*notes[:1], *more]


def times_of(trials: Sequence[Trial]) -> list[float]:
    """Return every time in s that the trials have: alignment and waiting times."""
    return [each for one in trials for each in (one.time, one.waited) if each is not None]
