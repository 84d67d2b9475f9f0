"""The regime of devices by figure, as a table: whether it is the vibration that aligns the part."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from model.study.claims.reading import Data
from model.study.claims.regime import Regime, regime_of
from model.study.config import Study
from model.study.csv_tables import csv_text, read_rows
from model.study.identification.candidate import Space, searched_of
from model.study.identification.evaluate import datasets_of

PRESENT = "present"  # name of the study's device in the table


class Row(NamedTuple):
    """The regime of one figure of one device."""

    device: str
    figure: str
    regime: Regime


def own_set(study: Study) -> dict[str, float]:
    """Return the study's device and operating points as the search states a set."""
    points = study.identification.law.operating_points
    held = {
        f"{figure}.{name}": getattr(study.parameters(figure), name)
        for figure, names in points.items()
        for name in names
    }
    return {**searched_of(study.structure), **held}


def regimes_of(space: Space, sets: Mapping[str, Mapping[str, float]]) -> list[Row]:
    """Return the regime of every figure of a space, of sets by device."""
    found = []
    for device, values in sets.items():
        (made,) = datasets_of(space, space.point_of(values)[None], space.figures)
        found += [Row(device, name, regime_of(Data(made), name)) for name in space.figures]
    return found


def regimes_text(rows: list[Row]) -> str:
    """Return the table as CSV text."""
    columns = ("device", "figure", *Regime._fields)
    return csv_text(
        columns,
        [
            {
                "device": row.device,
                "figure": row.figure,
                **{name: f"{value:.4g}" for name, value in row.regime._asdict().items()},
            }
            for row in rows
        ],
    )


def read_regimes(path: Path) -> list[Row]:
    """Return the rows of such a table.

    Raises:
        TableError: a file that is missing, empty, or not such a table.
    """

    def read(row: Mapping[str, str]) -> Row:
        return Row(
            row["device"], row["figure"], Regime(*(float(row[name]) for name in Regime._fields))
        )

    return read_rows(path, "regimes", read)
