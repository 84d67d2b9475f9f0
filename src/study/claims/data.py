"""Tables that claims are judged by: runs are rows, their parameters and results columns.

``Dataset.to_dataframe()`` makes a table. A history has a row for each moment until the part aligns,
with the results of the run in each. Columns that a dataset does not have:

device: number of the device, from 0: a table may hold the runs of several.
row: value of the first dimension, by which rows of a map and curves differ; 0 in a history.
curve: the same in a dataset of curves; 0 in others.
aligned, settled: flags, from the outcome.
stays, goes_in: flags of parts that align, and do not climb out of the slot again, or go in to the
    depth of insertion: from the outcome in the insertion scene, where a dataset has it.
tau: alignment time, NaN for a part that does not align.

A sensitive run ends differently at another tolerance. Its row is there, but no claim depends on it.
"""

from collections.abc import Mapping
from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from model.events.outcomes import InsertionOutcome, Outcome

if TYPE_CHECKING:
    import xarray as xr

Column = NDArray[Any]
Rows = NDArray[np.intp]
_NOT_STAYING = (InsertionOutcome.CLIMBED_OUT, InsertionOutcome.FAILED)


class MissingDataError(LookupError):
    """A dataset that a claim needs, or a value in it, is missing."""


def table_of(dataset: "xr.Dataset") -> pd.DataFrame:
    """Return the table of a dataset of the study.

    Variables over other dimensions than those of the outcome, or of a history's time, are left out.
    """
    runs = dataset["outcome"].dims
    dimensions = {*(runs or dataset["time"].dims)}
    names = [name for name, values in dataset.data_vars.items() if {*values.dims} <= dimensions]
    frame = dataset[names].to_dataframe().reset_index()
    table = with_columns(frame, dataset.attrs["kind"], str(runs[0]) if runs else None)
    return table if runs else table[~(table["time"] > table["tau"])]


def with_columns(frame: pd.DataFrame, kind: str, first: str | None) -> pd.DataFrame:
    """Return the table of runs, with the columns that are derived.

    Args:
        frame: parameters and results of the runs.
        kind: of the sweep; see ``Sweep``.
        first: name of its first dimension.
    """
    aligned = frame["outcome"] == Outcome.ALIGNED
    row = frame[first] if first else 0.0
    derived = {
        "device": frame.get("device", 0),
        "row": row,
        "curve": row if kind == "curves" else 0.0,
        "aligned": aligned,
        "settled": frame["outcome"] == Outcome.SETTLED,
        "tau": frame["tau_align"].where(aligned),
    }
    if "insertion" in frame:
        derived["goes_in"] = aligned & (frame["insertion"] == InsertionOutcome.INSERTED)
        derived["stays"] = aligned & ~frame["insertion"].isin(_NOT_STAYING)
    return frame.assign(**derived)


class _Columns(dict[str, Column]):
    """Columns of a table and expressions of them, shape (rows,), found when first asked for.

    Pandas takes a fifth of a millisecond to read an expression, of few rows or of thousands.
    """

    def __init__(self, table: pd.DataFrame) -> None:
        super().__init__()
        self.table = table

    def __missing__(self, text: str) -> Column:
        if text in self.table:
            self[text] = self.table[text].to_numpy()
        elif text.isidentifier():
            raise KeyError(text)
        else:
            # "python": numexpr, where it is installed, rounds otherwise.
            with np.errstate(divide="ignore", invalid="ignore"):
                self[text] = pd.eval(text, "pandas", "python", resolvers=[self])
        return self[text]


class Tables:
    """Tables by the names of their datasets, and one of the devices whose runs they hold.

    Attributes:
        frames: the tables by name, such as "fig06", or "pressed" for a run made for the claims.
    """

    def __init__(self, frames: Mapping[str, pd.DataFrame]) -> None:
        self.frames = frames
        self._columns: dict[tuple[str, ...], _Columns] = {}
        self._devices: dict[tuple[str, ...], dict[int, Rows]] = {}
        self._rows: dict[tuple[object, ...], dict[float, Rows]] = {}
        self._device = 0

    @classmethod
    def of(cls, datasets: "Mapping[str, xr.Dataset]") -> "Tables":
        """Return the tables of datasets by name."""
        return cls({name: table_of(dataset) for name, dataset in datasets.items()})

    def at(self, device: int) -> "Tables":
        """Return the tables with another device; a column is found once for all devices."""
        other = copy(self)
        other._device = device
        return other

    def alone(self) -> dict[str, pd.DataFrame]:
        """Return the tables of this device by name, as those of the only one."""
        return {
            name: table[table["device"] == self._device].assign(device=0)
            for name, table in self.frames.items()
        }

    def column(self, names: tuple[str, ...], text: str) -> Column:
        """Return an expression of columns as pandas reads it, shape (rows of all devices,).

        Of several names it is that of their tables in one; ``figure`` is then the place of the name
        among them, from 0.

        Raises:
            MissingDataError: there is no dataset of a name, or no column that the text names.
        """
        if names not in self._columns:
            if missing := [name for name in names if name not in self.frames]:
                raise MissingDataError(f"there is no dataset {missing[0]}")
            tables = [self.frames[name] for name in names]
            if len(tables) > 1:
                tables = [pd.concat([t.assign(figure=row) for row, t in enumerate(tables)])]
            self._columns[names] = _Columns(tables[0])
        try:
            return self._columns[names][text]
        except (KeyError, NameError) as error:
            raise MissingDataError(f"{', '.join(names)} has no column for {text!r}") from error

    def rows(self, names: tuple[str, ...], where: str = "", each: str = "") -> dict[float, Rows]:
        """Return the numbers of the device's rows that meet ``where``, a query of pandas.

        They are grouped by the values of the column ``each``, in rising order; without it all are
        in one group. Sensitive runs are left out, so that a group may be empty.

        Raises:
            MissingDataError: there is no dataset of a name, or no row meets ``where``.
        """
        key = self._device, names, where, each
        if key not in self._rows:
            rows = self._of_device(names)
            rows = rows[self.column(names, where)[rows]] if where else rows
            if not rows.size:
                raise MissingDataError(f"{', '.join(names)} has no run with {where}")
            by = self.column(names, each)[rows] if each else np.zeros(rows.size)
            known = self.column(names, "sensitive")[rows] == 0
            self._rows[key] = {value: rows[known & (by == value)] for value in np.unique(by)}
        return self._rows[key]

    def _of_device(self, names: tuple[str, ...]) -> Rows:
        device = self.column(names, "device")
        if names not in self._devices:
            order = np.argsort(device, kind="stable")
            devices, starts = np.unique(device[order], return_index=True)
            split = np.split(order, starts[1:])
            self._devices[names] = dict(zip(devices.tolist(), split, strict=True))
        return self._devices[names].get(self._device, np.empty(0, dtype=np.intp))

    def values(self, name: str, text: str) -> Column:
        """Return an expression of columns on the device's rows of a dataset, shape (rows,)."""
        (rows,) = self.rows((name,)).values()
        return self.column((name,), text)[rows]
