"""Share of the vibration in a figure that overshoot explains, and what another start changes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from model.events.outcomes import Outcome, Reason, Unvibrated
from model.study.claims import judge
from model.study.sweeps import Sweep

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


# --- The other start ----------------------------------------------------------------------------


def from_other_start(sweep: Sweep) -> Sweep:
    """Return a figure's sweep with the other start: pressed, or simultaneous if it is pressed."""
    start = "simultaneous" if sweep.settings.start == "pressed" else "pressed"
    settings = sweep.settings.model_copy(update={"start": start})
    return sweep.model_copy(update={"settings": settings})


@dataclass(frozen=True)
class ByStart:
    """A figure from both starts.

    Attributes:
        aligned, other_aligned: share of the points that align from its own start and the other.
        no_rest: share that does not rest under the press.
        ratio: median of the other start's duration over its own, of points that align from both;
            NaN if there are none.
    """

    aligned: float
    other_aligned: float
    no_rest: float
    ratio: float


def by_start(own: "xr.Dataset", other: "xr.Dataset") -> ByStart:
    """Compare the datasets of a figure from two starts."""
    outcome, of_other = (np.ravel(each["outcome"].values) for each in (own, other))
    tau, other_tau = (np.ravel(each["tau_align"].values) for each in (own, other))
    both = (outcome == Outcome.ALIGNED) & (of_other == Outcome.ALIGNED) & (tau > 0.0)
    reasons = np.concatenate([np.ravel(each["reason"].values) for each in (own, other)])
    return ByStart(
        aligned=float((outcome == Outcome.ALIGNED).mean()),
        other_aligned=float((of_other == Outcome.ALIGNED).mean()),
        no_rest=float((reasons == Reason.NO_REST).sum() / outcome.size),
        ratio=float(np.median(other_tau[both] / tau[both])) if both.any() else float("nan"),
    )


def changed_claims(
    own: "Mapping[str, xr.Dataset]", other: "Mapping[str, xr.Dataset]"
) -> list[tuple[str, str, str]]:
    """Return (claim, verdict from its own start, from the other) where the two differ.

    Only claims that figures alone decide, since the claims' own runs are not computed anew.
    """
    return [
        (claim.id, first.verdict, second.verdict)
        for (claim, first), (_, second) in zip(judge(own), judge(other), strict=True)
        if first.verdict != second.verdict
    ]
