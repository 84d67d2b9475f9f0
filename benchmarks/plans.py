"""Plans of the comparison of methods: without texts, so that new wording computes nothing."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from model.study.config.methods import HardCases, Ladder
from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings

if TYPE_CHECKING:
    from model.study.config.study import Study

# Paths of the pictures of speed against error, below the results root and without extension.
PICTURES: Mapping[str, str] = {
    "evaluations": "figures/precision",
    "times": "benchmarks/precision",
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
