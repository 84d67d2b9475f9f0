"""Labels and cells of the axes that figures of the study share."""

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.show.words import math

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

FAILED_LABEL = "run failed"
NOT_ALIGNED = "does not align"
NOT_INSERTED = "aligns, but does not go in"


def symbol_of(coordinate: "xr.DataArray") -> str:
    """Return a parameter's symbol as mathematical text; its name where it has none."""
    symbol = coordinate.attrs.get("symbol", coordinate.name)
    # What has no symbol of its own carries its name.
    return str(symbol) if symbol == coordinate.name else math(symbol)


def axis_label(coordinate: "xr.DataArray") -> str:
    """Return words and symbol of a parameter: "initial pressing force $f_{0}$"."""
    words = str(coordinate.attrs.get("long_name", coordinate.name))
    words = re.split(r"; | \(", words, maxsplit=1)[0]  # what follows explains, it does not name
    symbol, unit = symbol_of(coordinate), coordinate.attrs.get("units", "1")
    label = words if symbol == words else f"{words} {symbol}"
    return label if unit == "1" else f"{label} in {unit}"


def cell_edges(values: Floats) -> Floats:
    """Return the edges, shape (n + 1,), of the cells around ``values``, shape (n,)."""
    middles = 0.5 * (values[1:] + values[:-1])
    first, last = 1.5 * values[0] - 0.5 * values[1], 1.5 * values[-1] - 0.5 * values[-2]
    return np.concatenate([[first], middles, [last]])


def runs_of(mask: Bools) -> Iterator[tuple[int, int]]:
    """Yield the runs of True in ``mask``, shape (n,), as (first, one past the last)."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    yield from zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True)


def not_inserted(dataset: "xr.Dataset") -> Bools:
    """Return where a part aligns and does not go in; nowhere if the dataset does not say."""
    aligned = np.asarray(dataset["outcome"].values == Outcome.ALIGNED)
    if "insertion" not in dataset:
        return np.zeros_like(aligned)
    flags = dataset["insertion"].attrs
    place = flags["flag_meanings"].split().index("inserted")
    return aligned & (dataset["insertion"].values != flags["flag_values"][place])
