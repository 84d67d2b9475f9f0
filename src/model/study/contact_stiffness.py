"""Contact stiffness and damping: which features of Figs. 6, 12 and 13 are the part's.

The base is a spring and a damper only so that there is a contact force to compute: k_a and h_a are
devices of the method. What does not change as the base gets stiff belongs to the part. What the
damping changes even then is the rebound of impacts, which no stiffness decides.
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
    """One base: its stiffness, its damping, and that over the critical."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    stiffness: float
    ratio: float
    damping: float


class StiffnessPlan(Plan):
    """One figure on several bases; its JSON is its identity."""

    figure: str
    variations: list[Variation]
    sweeps: list[Sweep]


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
