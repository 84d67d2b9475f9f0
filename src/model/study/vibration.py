"""Share of the vibration in a figure that overshoot explains."""

from typing import TYPE_CHECKING

import numpy as np

from model.events.outcomes import Outcome, Unvibrated

if TYPE_CHECKING:
    import xarray as xr


def overshoot_of(dataset: "xr.Dataset") -> float:
    """Return the share of the aligned points whose twin aligns, but rests if it is pressed slowly.

    NaN where no point aligns.
    """
    aligned = dataset["outcome"].values == Outcome.ALIGNED
    static = dataset["unvibrated"].values[aligned] == Unvibrated.ALIGNS
    rests_slowly = np.isfinite(dataset["slow_tilt"].values[aligned])
    return float((static & rests_slowly).mean()) if static.size else float("nan")
