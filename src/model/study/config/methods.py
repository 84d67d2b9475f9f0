"""Comparison of methods: work and precision, figures with fixed steps, hard cases."""

from typing import Annotated

from pydantic import Field, model_validator

from model.physics.parameters import check_name
from model.study.config.base import ParameterValues, Strict, Text, Tolerance, check_falling
from model.study.config.figures import GRIDDED


class Case(Strict):
    """One operating point at which methods are compared, from a figure of the study.

    Without ``until`` it aligns, and the error is that of the alignment time; with it, the error is
    that of the state at τ = ``until``, which must come before any alignment.
    """

    title: Text
    reason: Text
    figure: str
    at: ParameterValues
    until: float | None = Field(default=None, gt=0.0)


class Ladder(Strict):
    """How finely each method is run: tolerances of the adaptive ones, steps of the others."""

    tolerances: list[float] = Field(min_length=1)
    steps: list[float] = Field(min_length=1)
    true_tolerance: Tolerance
    max_evaluations: int = Field(ge=1)
    max_evaluations_scipy: int = Field(ge=1)

    @model_validator(mode="after")
    def _gets_finer(self) -> "Ladder":
        if min(self.tolerances) < 1e-14 or max(self.tolerances) > 1e-2:
            raise ValueError(f"tolerances = {self.tolerances}: must be between 1e-14 and 1e-2")
        if not self.true_tolerance < min(self.tolerances):
            raise ValueError(
                f"true_tolerance = {self.true_tolerance}: must be smaller than all tolerances, "
                "since their errors are measured against it"
            )
        for name, values in {"tolerances": self.tolerances, "steps": self.steps}.items():
            check_falling(name, values)
        return self


class FixedSteps(Strict):
    """Figures computed anew with fixed steps, to count the points that come out wrong.

    ``figures`` says of each how much of it: every n-th value along its axes.
    """

    steps: list[float] = Field(min_length=1)
    tau_tolerance: float = Field(gt=0.0)
    figures: dict[str, Annotated[int, Field(ge=1)]] = Field(min_length=1)

    @model_validator(mode="after")
    def _can_be_run(self) -> "FixedSteps":
        check_falling("steps", self.steps)
        for name in self.figures:
            check_name(name, GRIDDED, "figure with a grid")
        return self


class Precision(Strict):
    """The section on speed against error."""

    cases: dict[str, Case] = Field(min_length=1)
    ladder: Ladder
    fixed_steps: FixedSteps


class HardCase(Strict):
    """One scene that is hard to integrate, and how long it is run: the baseline but for ``at``.

    ``max_evaluations`` takes the place of the section's for a case that is long by itself.
    """

    title: Text
    at: ParameterValues
    until: float = Field(gt=0.0)
    max_evaluations: int | None = Field(default=None, ge=1)


class StiffnessCases(Strict):
    """A case for each pair of stiffness and damping of the base."""

    stiffness: list[float] = Field(min_length=1)
    damping: list[float] = Field(min_length=1)
    at: ParameterValues
    until: float = Field(gt=0.0)


class HardCases(Strict):
    """The section on hard cases: every method on every case, and when its answer counts.

    Adaptive methods run at ``tolerance``, the others with steps of ``step``. An answer is accurate
    if it is off by no more than ``accurate``; a method is broken where it needs more evaluations
    than it may.
    """

    tolerance: Tolerance
    step: float = Field(gt=0.0)
    true_tolerance: Tolerance
    accurate: float = Field(gt=0.0)
    max_evaluations: int = Field(ge=1)
    max_evaluations_scipy: int = Field(ge=1)
    base: StiffnessCases
    cases: dict[str, HardCase] = Field(min_length=1)

    @property
    def all_cases(self) -> dict[str, HardCase]:
        """The cases by name: those of the base first, stiffness by stiffness."""
        found = {}
        for stiffness in self.base.stiffness:
            for damping in self.base.damping:
                values = {"contact_stiffness": stiffness, "contact_damping": damping}
                found[f"base_{stiffness:g}_{damping:g}"] = HardCase(
                    title=f"base k_a = {stiffness:g}, h_a = {damping:g}",
                    at=self.base.at | values,
                    until=self.base.until,
                )
        return found | self.cases
