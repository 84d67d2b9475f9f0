"""Made-up datasets in the study's format, and artists of their figures by their labels."""

import json

import numpy as np
import xarray as xr

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS

NAN = np.nan
# Gaps at the start, inside and at the end; single points between gaps; a curve without any.
DURATIONS = np.array(
    [
        [5.0, 4.5, 4.0, 3.8, 3.5, 3.2, 3.0, 2.9, 2.8, 2.7],
        [NAN, NAN, 6.0, NAN, 5.0, 4.8, NAN, NAN, 4.0, NAN],
        [9.0, NAN, NAN, 7.0, 6.9, 6.8, NAN, 6.6, 6.5, 6.4],
        [NAN] * 10,
    ]
)


def grid(kind: str, y: str, x: str, durations: np.ndarray) -> xr.Dataset:
    """A dataset in the study's format with these durations, settled where there is none."""
    rows, columns = durations.shape

    def described(name, values):
        field = FIELDS[name]
        return name, values, {"long_name": field.description, "symbol": field.symbol, "units": "1"}

    outcome = np.where(np.isnan(durations), Outcome.SETTLED, Outcome.ALIGNED).astype(np.int8)
    return xr.Dataset(
        {
            "tau_align": ((y, x), durations, {"long_name": "alignment duration", "symbol": "τ"}),
            "outcome": ((y, x), outcome),
            "sensitive": ((y, x), np.zeros_like(outcome)),
        },
        {
            y: described(y, np.linspace(1.0, 4.0, rows)),
            x: described(x, np.linspace(0.25, 9.25, columns)),
        },
        {"kind": kind, "figure": "fig00", "readings": json.dumps({})},
    )


def named(artists, label: str) -> list:
    return [artist for artist in artists if artist.get_label() == label]


def curve_lines(axes) -> list:
    return [line for line in axes.lines if " = " in line.get_label() and line.get_label()[0] == "$"]


def followed(dataset: xr.Dataset, lost: list[tuple[int, int]]) -> xr.Dataset:
    """The dataset with ``insertion``: all that align go in but those at ``lost``, which jam."""
    flags = np.where(dataset["outcome"].values == Outcome.ALIGNED, 5, -1).astype(np.int8)
    for place in lost:
        flags[place] = 6
    attributes = {"flag_values": [-1, 5, 6], "flag_meanings": "not_aligned inserted jammed"}
    return dataset.assign(insertion=(dataset["outcome"].dims, flags, attributes))
