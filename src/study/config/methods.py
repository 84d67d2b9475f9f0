"""Cost against error, on usual and on hard cases."""

from pydantic import Field, model_validator

from model.sweeps.axes import Strict, Tolerance
from study.config.base import Falling, ParameterValues, Text


class Case(Strict):
    """Operating point at which error and cost are measured.

    Without ``until`` the part must align, and the error is that of the alignment time. With it, the
    error is that of the state at τ = ``until``, before any alignment.
    """

    title: Text
    """Title of the case."""
    reason: Text
    """Reason for the choice of the case."""
    figure: str
    """Figure whose operating point the case takes."""
    at: ParameterValues
    """Parameters at other values than the figure's."""
    until: float | None = Field(default=None, gt=0.0)
    """Time τ at which the states are compared; null to compare alignment times."""


class Ladder(Strict):
    """Tolerances of the runs and of the true run."""

    tolerances: Falling
    """Tolerances, falling."""
    true_tolerance: Tolerance
    """Tolerance of the true run."""
    max_evaluations: int = Field(ge=1)
    """Evaluations after which the ladder ends."""

    @model_validator(mode="after")
    def _gets_finer(self) -> "Ladder":
        if min(self.tolerances) < 1e-14 or max(self.tolerances) > 1e-2:
            raise ValueError(f"tolerances = {self.tolerances}: must be between 1e-14 and 1e-2")
        if not self.true_tolerance < min(self.tolerances):
            raise ValueError(
                f"true_tolerance = {self.true_tolerance}: must be smaller than all tolerances, "
                "since their errors are measured against it"
            )
        return self


class HardCase(Strict):
    """Case that is hard to integrate: the baseline with other values, and the length of the run."""

    title: Text
    """Title of the case."""
    at: ParameterValues
    """Parameters at other values than the baseline's."""
    until: float = Field(gt=0.0)
    """Time τ at which the run ends."""
    max_evaluations: int | None = Field(default=None, ge=1)
    """Evaluations after which the ladder ends; null for the section's."""


class StiffnessCases(Strict):
    """Cases for all pairs of stiffness and damping of the base."""

    stiffness: list[float] = Field(min_length=1)
    """Stiffnesses k_a of the base."""
    damping: list[float] = Field(min_length=1)
    """Dampings h_a of the base."""
    at: ParameterValues
    """Parameters at other values than the baseline's."""
    until: float = Field(gt=0.0)
    """Time τ at which the runs end."""


class HardCases(Strict):
    """Cases that are hard to integrate, and how they are solved."""

    ladder: Ladder
    """Tolerances and limit of evaluations on these cases."""
    independent: list[str] = Field(default_factory=list)
    """Cases whose true solution is the independent one, which takes seconds of some."""
    base: StiffnessCases
    """Cases of stiff and damped bases."""
    cases: dict[str, HardCase] = Field(min_length=1)
    """Further cases, by name."""

    @property
    def all_cases(self) -> dict[str, HardCase]:
        """Cases by name; the cases of stiff bases first, ordered by stiffness."""
        bases = {}
        for stiffness in self.base.stiffness:
            for damping in self.base.damping:
                values = {"contact_stiffness": stiffness, "contact_damping": damping}
                bases[f"base_{stiffness:g}_{damping:g}"] = HardCase(
                    title=f"base k_a = {stiffness:,.10g}, h_a = {damping:,.10g}",
                    at=self.base.at | values,
                    until=self.base.until,
                )
        return bases | self.cases


class Precision(Strict):
    """Section on speed against error."""

    cases: dict[str, Case] = Field(min_length=1)
    """Cases that are compared, by name."""
    ladder: Ladder
    """Tolerances and limit of evaluations."""
    hard: HardCases
    """Cases that are hard to integrate."""

    @property
    def titles(self) -> dict[str, str]:
        """Titles of all cases by name, the hard ones last."""
        return {name: case.title for name, case in (self.cases | self.hard.all_cases).items()}
