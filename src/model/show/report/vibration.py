"""Section on the vibration: what the same parts do without it."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from model.events.outcomes import Outcome
from model.show.report.section import Results, Section, Table
from model.show.words import figure_title, percent
from model.study.claims.data import Data
from model.study.claims.regime import regime_of
from model.study.config.figures import COMPUTED
from model.study.vibration import overshoot_of

if TYPE_CHECKING:
    import xarray as xr

CAPTION = (
    "What vibration adds over tilt stiffness and pressing force. On the ticked side of the line "
    "the part rests on the edge if it is pressed slowly."
)


def section(results: Results) -> Section:
    """Return the section on the vibration."""
    own = {name: results.dataset(f"data/{name}.nc") for name in COMPUTED}
    content = {
        "added": results.picture("figures/maps/fig13_vibration", CAPTION),
        "shares": Table(
            ("figure", ">aligned", ">also unvibrated", ">of these by overshoot", ">do not rest",
             ">tilt, median", ">largest", ">corners inside", ">lift off"),
            [_shares(name, dataset) for name, dataset in own.items()],
        ),
    }  # fmt: skip
    return Section(
        "vibration", "What vibration adds", Path(__file__).with_suffix(".html.j2"), content
    )


def _shares(name: str, dataset: "xr.Dataset") -> Sequence[object]:
    found = regime_of(Data({name: dataset}), name)
    outcome = dataset["outcome"].values
    shares = found.static, overshoot_of(dataset), found.not_resting, found.corners, found.lift_offs
    static, overshoot, resting, corners, lifting = map(_percent, shares)
    tilts = (f"{np.degrees(tilt):.1f}°" for tilt in (found.tilt, found.tilt_largest))
    aligned = np.count_nonzero(outcome == Outcome.ALIGNED)
    head = figure_title(name), f"{aligned:,} of {outcome.size:,}"
    return *head, static, overshoot, resting, *tilts, corners, lifting


def _percent(share: float) -> str:
    return "" if math.isnan(share) else percent(share)
