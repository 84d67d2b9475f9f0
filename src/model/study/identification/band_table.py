"""The ensemble's bands on disk: a line for every place on a curve."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from model.study.csv_tables import csv_text, read_rows

Array = NDArray[np.float64]
_ALONG = ("x", "aligned", "low", "middle", "high")


@dataclass(frozen=True)
class Band:
    """One curve of a figure over an ensemble; arrays have shape (n,), dimensionless.

    Attributes:
        at: value of the family's parameter.
        x: the swept parameter; for Fig. 10 over the bare part's inertia.
        aligned: share of the sets that align.
        low: 5 % quantile of the durations of those, NaN where too few align.
        middle: median.
        high: 95 % quantile.
    """

    at: float
    x: Array
    aligned: Array
    low: Array
    middle: Array
    high: Array


def bands_text(bands: Mapping[str, tuple[Band, ...]]) -> str:
    """Return the table of bands by figure, numbers to four digits."""
    rows = (
        {"figure": name, "at": f"{band.at:g}"}
        | {column: f"{getattr(band, column)[i]:.4g}" for column in _ALONG}
        for name, each in bands.items()
        for band in each
        for i in range(band.x.size)
    )
    return csv_text(("figure", "at", *_ALONG), rows)


def read_bands(path: Path) -> dict[str, tuple[Band, ...]]:
    """Return the bands that ``bands_text`` wrote to ``path``.

    Raises:
        TableError: a file that is missing or not such a table.
    """
    curves: dict[str, dict[float, list[list[float]]]] = {}
    for name, at, along in read_rows(path, "bands", _place):
        curves.setdefault(name, {}).setdefault(at, []).append(along)
    return {
        name: tuple(Band(at, *np.array(places).T) for at, places in each.items())
        for name, each in curves.items()
    }


def _place(row: dict[str, str]) -> tuple[str, float, list[float]]:
    return row["figure"], float(row["at"]), [float(row[column]) for column in _ALONG]
