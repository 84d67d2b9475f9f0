"""Figures 6, 12 and 13 on bases of other contact stiffness k_a and damping h_a.

The base is a spring and a damper only so that a contact force can be computed. A feature that stays
the same as the base gets stiffer is a property of the part. Damping decides how impacts rebound,
at any stiffness.
"""

import math

import xarray as xr
from pydantic import BaseModel, ConfigDict

from model.physics.parameters import Parameters
from model.study.config import Curves, Map, Study
from model.study.datasets import compute_chunk, merge_chunks
from model.study.plan import Plan
from model.study.sweeps import Sweep, sweep_of

VARIATION = "variation"
RATIO = "damping_ratio"


class Variation(BaseModel):
    """One base: k_a, damping over the critical, and h_a."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    stiffness: float
    ratio: float
    damping: float


class StiffnessPlan(Plan):
    """The computation of one figure on several bases."""

    figure: str
    variations: list[Variation]
    sweeps: list[Sweep]


def critical_damping(parameters: Parameters, stiffness: float) -> float:
    """Return h_a at which the contact at the start, as an oscillator, is critically damped.

    A unit force at the edge accelerates the part there by 1 + s²/I_φ, where s is its arm.
    """
    arm = parameters.slot_half_width - parameters.misalignment
    return 2.0 * math.sqrt(stiffness / (1.0 + arm**2 / parameters.inertia))


def variations_of(study: Study, figure: str) -> list[Variation]:
    """Return the bases of a figure: the device's own, then other stiffnesses, then dampings."""
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
    """Return the plan of ``figure``, one of ``study.contact_stiffness.figures``."""
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
    """The sweep of the figure on fewer points."""
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
    """Compute a figure on all bases, along the dimension ``variation``."""
    parts = []
    for variation, sweep in zip(plan.variations, plan.sweeps, strict=True):
        part = merge_chunks(sweep, title, title, [compute_chunk(sweep, 0, 1, cores)])
        ratio = ((), variation.ratio, {"long_name": "damping over the critical", "units": "1"})
        parts.append(part.assign_coords({RATIO: ratio}))
    varied = ["contact_stiffness", "contact_damping", RATIO]
    joined = xr.concat(parts, VARIATION, coords=varied, combine_attrs="override")
    return joined.assign_attrs(sweep=plan.identity)
