"""Made-up datasets in the study's format, and artists of their figures by their labels."""

import json

import numpy as np
import xarray as xr

from model.events.outcomes import Outcome, Reason
from model.physics.parameters import FIELDS
from vibralign.device.paper import baseline

NAN = np.nan
FREQUENCY = 0.5  # its period is 4 π: no two neighbours of DURATIONS differ by a third of it
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
    """Return a dataset in the study's format with these durations; NaN is a settled run."""
    rows, columns = durations.shape

    def described(name, values):
        field = FIELDS[name]
        return name, values, {"long_name": field.description, "symbol": field.symbol, "units": "1"}

    outcome = np.where(np.isnan(durations), Outcome.SETTLED, Outcome.ALIGNED).astype(np.int8)
    made_up = xr.Dataset(
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
    return made_up if "frequency" in (y, x) else made_up.assign_coords(frequency=FREQUENCY)


def named(artists, label: str) -> list:
    return [artist for artist in artists if artist.get_label() == label]


def curve_lines(axes) -> list:
    return [line for line in axes.lines if " = " in line.get_label() and line.get_label()[0] == "$"]


def jamming_data() -> xr.Dataset:
    """Return parts in two clearances, jammed above the wedging limit; comments name exceptions."""
    clearance, stiffness = np.array([0.03, 0.09]), np.array([5.0, 20.0])
    friction = np.array([0.1, 0.3, 0.6, 0.9])
    dims = ("clearance", "tilt_stiffness", "friction")
    tilt = np.broadcast_to(np.array([0.4, 0.2])[:, None], (2, 2, 4)).copy()
    limit = (1.0 + clearance[:, None, None] - np.cos(tilt)) / np.sin(tilt)
    outcome = np.where(friction > limit, Outcome.JAMMED, Outcome.INSERTED).astype(np.int8)
    outcome[0, 0, 0] = Outcome.JAMMED  # for lack of force
    outcome[1, 1, 0] = Outcome.CLIMBED_OUT
    outcome[1, 0, 3] = Outcome.SETTLED  # never fell in
    fell = outcome != Outcome.SETTLED
    reason = np.where(outcome == Outcome.JAMMED, Reason.WEDGED, Reason.NONE).astype(np.int8)
    reason[0, 0, 0] = Reason.LACK_OF_FORCE
    variables = {
        "outcome": outcome,
        "reason": reason,
        "tau_align": np.where(fell, 2.0, NAN),
        "tilt_at_alignment": np.where(fell, tilt, NAN),
        "insertion_depth": np.full(tilt.shape, 0.8),
    }
    coordinates = {"clearance": clearance, "tilt_stiffness": stiffness, "friction": friction}
    described = {
        name: (name, values, {"long_name": name, "symbol": FIELDS[name].symbol, "units": "1"})
        for name, values in coordinates.items()
    }
    data = {name: (dims, values) for name, values in variables.items()}
    attributes = {"kind": "map", "figure": "jamming", "config_hash": "made up"}
    held = baseline().replace(half_width=0.9).given()
    fixed = {name: np.nan if value is None else value for name, value in held.items()}
    return xr.Dataset(data, fixed | described, attributes)
