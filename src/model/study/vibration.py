"""What vibration adds: shares of a figure or map, by the ends with and without it."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import SUCCESSES, Outcome, Unvibrated
from model.events.scenes import ALIGNMENT
from model.runs.settings import SCENES, Settings

if TYPE_CHECKING:
    import xarray as xr

BOTH, ONLY_VIBRATED, ONLY_PRESSED, NEITHER = range(4)


def success_of(dataset: "xr.Dataset") -> Outcome:
    """Return the outcome of a run that ends well in the scene of a map or figure."""
    return Settings(scene=SCENES[dataset.attrs.get("scene", ALIGNMENT.name)]).success


def added(dataset: "xr.Dataset") -> NDArray[np.int64]:
    """Return what vibration adds at every point of a map or figure, in the shape of its outcome.

    BOTH: the part aligns with and without vibration; ONLY_VIBRATED, ONLY_PRESSED: it aligns with
    vibration alone, or without alone; NEITHER: it aligns in no way.
    """
    vibrated = np.isin(dataset["outcome"].values, SUCCESSES)
    pressed = dataset["unvibrated"].values == Unvibrated.ALIGNS
    return np.select(
        [vibrated & pressed, vibrated, pressed], [BOTH, ONLY_VIBRATED, ONLY_PRESSED], NEITHER
    )


def overshoot_of(dataset: "xr.Dataset") -> float:
    """Return the share of aligned points that align unvibrated too, but rest if pressed slowly.

    NaN where no point aligns.
    """
    aligned = dataset["outcome"].values == Outcome.ALIGNED
    static = dataset["unvibrated"].values[aligned] == Unvibrated.ALIGNS
    rests_slowly = np.isfinite(dataset["slow_tilt"].values[aligned])
    return float((static & rests_slowly).mean()) if static.size else float("nan")
