"""Plan of error against cost: without texts, so that new wording computes nothing."""

from typing import TYPE_CHECKING

from model.physics.parameters import Parameters
from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings
from study.config.methods import Ladder

if TYPE_CHECKING:
    from study.config.study import Study


class CasePlan(Plan):
    """Numbers of one case.

    Attributes:
        parameters: the operating point.
        until: time τ at which a run ends that has not aligned.
        ladder: tolerances and limit of evaluations.
        independent: True if the independent solution gives its true solution.
    """

    parameters: dict[str, float | None]
    until: float
    ladder: Ladder
    independent: bool = True


class PrecisionPlan(Plan):
    """Plan of error against cost: cases by name, the hard ones last."""

    cases: dict[str, CasePlan]
    settings: RunSettings


def precision_plan(study: "Study") -> PrecisionPlan:
    """Return the plan of a study."""
    precision, hard = study.precision, study.precision.hard
    cases = {
        name: CasePlan(
            parameters=study.case(name).given(),
            until=case.until or study.settings.horizon,
            ladder=precision.ladder,
        )
        for name, case in precision.cases.items()
    }
    for name, each in hard.all_cases.items():
        limited = {"max_evaluations": each.max_evaluations or hard.ladder.max_evaluations}
        cases[name] = CasePlan(
            parameters=study.baseline.replace(**each.at).given(),
            until=each.until,
            ladder=hard.ladder.model_copy(update=limited),
            independent=name in hard.independent,
        )
    return PrecisionPlan(cases=cases, settings=study.settings)


def independent_cases(study: "Study") -> dict[str, tuple[Parameters, float]]:
    """Return the cases whose truth is the independent solution: parameters and horizon, by name."""
    return {
        name: (Parameters(**case.parameters), case.until)  # type: ignore[arg-type]
        for name, case in precision_plan(study).cases.items()
        if case.independent
    }
