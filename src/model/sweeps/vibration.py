"""Effect of vibration: points of a figure or map by their outcomes with and without it."""

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
    """Return the successful outcome in the scene of a map or figure."""
    return Settings(scene=SCENES[dataset.attrs.get("scene", ALIGNMENT.name)]).success


def added(dataset: "xr.Dataset") -> NDArray[np.int64]:
    """Return one of four numbers for every point of a map or figure, in the shape of ``outcome``.

    BOTH: the part aligns with and without vibration; ONLY_VIBRATED: only with it; ONLY_PRESSED:
    only without it; NEITHER: not at all.
    """
    vibrated = np.isin(dataset["outcome"].values, SUCCESSES)
    pressed = dataset["unvibrated"].values == Unvibrated.ALIGNS
    return np.select(
        [vibrated & pressed, vibrated, pressed], [BOTH, ONLY_VIBRATED, ONLY_PRESSED], NEITHER
    )


def overshoot_of(dataset: "xr.Dataset") -> float:
    """Return the share of aligned points that align unvibrated too, but rest if pressed slowly.

    NaN if no point aligns.
    """
    aligned = dataset["outcome"].values == Outcome.ALIGNED
    static = dataset["unvibrated"].values[aligned] == Unvibrated.ALIGNS
    rests_slowly = np.isfinite(dataset["slow_tilt"].values[aligned])
    return float((static & rests_slowly).mean()) if static.size else float("nan")
