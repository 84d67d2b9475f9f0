"""Plans of the comparison of methods: without texts, so that new wording computes nothing."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from model.study.config.base import Axis, Plan
from model.study.config.methods import HardCases, Ladder
from model.study.config.settings import RunSettings
from model.study.sweep import Sweep, sweep_of

if TYPE_CHECKING:
    from model.study.config.study import Study

# Paths of the pictures of speed against error, below the results root and without extension.
PICTURES: Mapping[str, str] = {
    "evaluations": "figures/precision",
    "times": "benchmarks/precision",
    "wrong_points": "figures/wrong_points",
}

# Path of the picture of hard cases.
HARD_PICTURES: Mapping[str, str] = {"stability": "figures/stability"}


class CasePlan(Plan):
    """Numbers of one case; ``until`` as in ``config.Case``."""

    parameters: dict[str, float | None]
    until: float | None


class PrecisionPlan(Plan):
    """Plan of the comparison of methods."""

    cases: dict[str, CasePlan]
    ladder: Ladder
    settings: RunSettings


def precision_plan(study: "Study") -> PrecisionPlan:
    """Return the comparison of a study."""
    cases = {
        name: CasePlan(parameters=study.case(name).given(), until=case.until)
        for name, case in study.precision.cases.items()
    }
    return PrecisionPlan(cases=cases, ladder=study.precision.ladder, settings=study.settings)


class HardCasesPlan(Plan):
    """Plan of the hard cases: every method on each."""

    parameters: dict[str, float | None]
    spec: HardCases
    settings: RunSettings


def hard_cases_plan(study: "Study") -> HardCasesPlan:
    """Return the hard cases of a study."""
    return HardCasesPlan(
        parameters=study.baseline.given(), spec=study.hard_cases, settings=study.settings
    )


class FixedStepPlan(Plan):
    """Plan of one figure with fixed steps.

    ``every`` = n keeps every n-th value of an axis, and all curves of a family.
    """

    sweep: Sweep
    every: int
    steps: list[float]
    tau_tolerance: float

    @property
    def kept(self) -> tuple[slice, ...]:
        """Slices of the values that are kept, one for each dimension of the sweep."""
        return tuple(
            slice(None, None, self.every if isinstance(dimension, Axis) else None)
            for dimension in self.sweep.dimensions
        )

    @property
    def metadata(self) -> dict[str, Any]:
        """Metadata of the sidecar: the sweep's, with the kept values and the steps."""
        kept = [
            {"parameter": dimension.parameter, "values": dimension.values[part]}
            for dimension, part in zip(self.sweep.dimensions, self.kept, strict=True)
        ]
        own = {"config_hash": self.identity, "dimensions": kept, "steps": self.steps}
        return {**self.sweep.metadata, **own}


def fixed_step_plan(study: "Study", figure: str) -> FixedStepPlan:
    """Return the plan of ``figure``, one of ``study.precision.fixed_steps.figures``."""
    spec = study.precision.fixed_steps
    return FixedStepPlan(
        sweep=sweep_of(study, figure),
        every=spec.figures[figure],
        steps=spec.steps,
        tau_tolerance=spec.tau_tolerance,
    )
