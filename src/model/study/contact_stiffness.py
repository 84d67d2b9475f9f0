"""Contact stiffness and damping: which features of Figs. 6, 12 and 13 are the part's.

The base is a spring and a damper only so that there is a contact force to compute: k_a and h_a are
devices of the method. What does not change as the base gets stiff belongs to the part. What the
damping changes even then is the rebound of impacts, which no stiffness decides.
"""

import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from model.physics.parameters import Parameters
from model.study.claims import Claim, Finding, judge
from model.study.config import Curves, Map, Study
from model.study.datasets import compute_chunk, merge_chunks
from model.study.sweeps import Sweep, sweep_of

VARIATION = "variation"
RATIO = "damping_ratio"
SAME = 0.05  # what can just be seen: of a duration, and of all runs


class Variation(BaseModel):
    """One base: its stiffness, its damping, and that over the critical."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    stiffness: float
    ratio: float
    damping: float


class StiffnessPlan(BaseModel):
    """One figure on several bases; its JSON is its identity."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    figure: str
    variations: list[Variation]
    sweeps: list[Sweep]

    @property
    def identity(self) -> str:
        """Hash of everything that the results depend on besides the code."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:16]


def critical_damping(parameters: Parameters, stiffness: float) -> float:
    """h_a at which the contact of the start, as an oscillator, is critically damped.

    The part answers a force at the edge with the acceleration 1 + s²/I_φ along it, s being the arm.
    """
    arm = parameters.slot_half_width - parameters.misalignment
    return 2.0 * math.sqrt(stiffness / (1.0 + arm**2 / parameters.inertia))


def variations_of(study: Study, figure: str) -> list[Variation]:
    """The bases on which a figure is computed: the device's own, then by stiffness and damping."""
    spec, own = study.contact_stiffness, study.parameters(figure)
    ratio = own.contact_damping / critical_damping(own, own.contact_stiffness)
    levels = [(own.contact_stiffness, ratio)]
    levels += [(stiffness, ratio) for stiffness in spec.stiffnesses]
    levels += [(stiffness, each) for stiffness in spec.damped_at for each in spec.damping_ratios]
    return [
        Variation(stiffness=k, ratio=z, damping=z * critical_damping(own, k))
        for k, z in dict.fromkeys(levels)
    ]


def stiffness_plan(study: Study, figure: str) -> StiffnessPlan:
    """What the study asks of ``figure``, one of ``study.contact_stiffness.figures``."""
    spec = study.contact_stiffness
    coarse = _coarse(study, figure)
    variations = variations_of(study, figure)
    sweeps = []
    for each in variations:
        base = {"contact_stiffness": each.stiffness, "contact_damping": each.damping}
        settings = study.settings.model_copy(
            update={"horizon": spec.horizon, "tolerance": spec.tolerance}
        )
        changed = {"parameters": {**coarse.parameters, **base}, "settings": settings}
        sweeps.append(coarse.model_copy(update=changed))
    return StiffnessPlan(figure=figure, variations=variations, sweeps=sweeps)


def _coarse(study: Study, figure: str) -> Sweep:
    """The figure's sweep on fewer points."""
    grid, spec = study.contact_stiffness.figures[figure], study.figures[figure]
    if isinstance(spec, Curves):
        swept = spec.swept.model_copy(update={"count": grid.points})
        family = spec.family.model_copy(update={"values": grid.family or spec.family.values})
        spec = spec.model_copy(update={"swept": swept, "family": family})
    elif isinstance(spec, Map):
        x, y = (axis.model_copy(update={"count": grid.points}) for axis in (spec.x, spec.y))
        spec = spec.model_copy(update={"x": x, "y": y})
    coarse = study.model_copy(update={"figures": {**study.figures, figure: spec}})
    return sweep_of(coarse, figure)


def stiffness_dataset(plan: StiffnessPlan, title: str, cores: int = 1) -> xr.Dataset:
    """A figure on all bases, along the dimension ``variation``."""
    parts = []
    for variation, sweep in zip(plan.variations, plan.sweeps, strict=True):
        part = merge_chunks(sweep, title, title, [compute_chunk(sweep, 0, 1, cores)])
        ratio = ((), variation.ratio, {"long_name": "damping over the critical", "units": "1"})
        parts.append(part.assign_coords({RATIO: ratio}))
    varied = ["contact_stiffness", "contact_damping", RATIO]
    joined = xr.concat(parts, VARIATION, coords=varied, combine_attrs="override")
    return joined.assign_attrs(sweep=plan.identity)


# --- What it shows ------------------------------------------------------------------------------


@dataclass(frozen=True)
class OnBase:
    """A figure on one base, and how far it is from that on the stiffest.

    Attributes:
        stiffness: k_a.
        ratio: damping over the critical.
        aligned: share of the runs that align.
        in_contact: share of those that never leave the base, NaN without any.
        other_end: share of the runs that align here and not there, or there and not here.
        other_time: share of those that align on both whose duration differs by more than ``SAME``.
        apart: median relative difference of those durations, NaN without any.
    """

    stiffness: float
    ratio: float
    aligned: float
    in_contact: float
    other_end: float
    other_time: float
    apart: float

    @property
    def looks_the_same(self) -> bool:
        """Whether a reader would see no difference: in no more than one run in twenty is any."""
        return self.other_end <= SAME and not self.other_time > SAME


def on_bases(dataset: xr.Dataset) -> list[OnBase]:
    """A figure on each base; sensitive points, of either base, are left out."""
    limit = stiffest(dataset)
    return [_compared(dataset, i, limit) for i in range(dataset.sizes[VARIATION])]


def stiffest(dataset: xr.Dataset) -> int:
    """Place of the stiffest base with the device's damping ratio."""
    own = dataset[RATIO].values == dataset[RATIO].values[0]
    return int(np.argmax(np.where(own, dataset["contact_stiffness"].values, 0.0)))


def _compared(dataset: xr.Dataset, place: int, limit: int) -> OnBase:
    def of(name: str) -> tuple[NDArray[Any], NDArray[Any]]:
        values = dataset[name].values
        return values[place].ravel(), values[limit].ravel()

    sensitive = of("sensitive")
    regular = (sensitive[0] == 0) & (sensitive[1] == 0)
    here, there = (each[regular] == 0 for each in of("outcome"))
    separations = of("separations")[0][regular][here]
    both = here & there
    tau, tau_there = (each[regular][both] for each in of("tau_align"))
    apart = np.abs(tau - tau_there) / tau_there
    return OnBase(
        stiffness=float(dataset["contact_stiffness"].values[place]),
        ratio=float(dataset[RATIO].values[place]),
        aligned=_share(here),
        in_contact=_share(separations == 0),
        other_end=_share(here != there),
        other_time=_share(apart > SAME),
        apart=float(np.median(apart)) if apart.size else math.nan,
    )


def _share(flags: NDArray[np.bool_]) -> float:
    return float(flags.mean()) if flags.size else math.nan


class ClaimOnBases(NamedTuple):
    """A claim with what is found of it on each base, the device's own first."""

    claim: Claim
    findings: tuple[Finding, ...]


def claims_on_bases(datasets: Mapping[str, xr.Dataset]) -> list[ClaimOnBases]:
    """Every claim that these figures let one judge, on each base."""
    count = min(dataset.sizes[VARIATION] for dataset in datasets.values())
    judged = [
        judge({name: dataset.isel({VARIATION: i}) for name, dataset in datasets.items()})
        for i in range(count)
    ]
    by_claim = zip(*judged, strict=True)
    rows = [ClaimOnBases(row[0][0], tuple(each for _, each in row)) for row in by_claim]
    return [row for row in rows if row.findings[0].verdict != "not checkable"]


def settled_from(rows: Sequence[OnBase]) -> float:
    """Least stiffness from which on, at the device's damping ratio, nothing changes any more.

    Infinite where only the stiffest base agrees with itself.
    """
    own = sorted((row for row in rows if row.ratio == rows[0].ratio), key=lambda row: row.stiffness)
    settled = math.inf
    for row in reversed(own[:-1]):
        if not row.looks_the_same:
            break
        settled = row.stiffness
    return settled
