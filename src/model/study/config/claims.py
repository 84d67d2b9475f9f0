"""Runs that only the claims need: the claims' own, and figures on other bases."""

from typing import Annotated

from pydantic import Field, model_validator

from model.physics.parameters import check_name
from model.study.config.base import Axis, Family, ParameterValues, Strict, Text, Tolerance
from model.study.config.figures import GRIDDED


class ClaimRun(Strict):
    """Curves that only the claims ledger reads, at the operating point of a figure."""

    title: Text
    """Title of the run."""
    figure: str
    """Figure whose operating point the run takes."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters held at other values than the figure's."""
    centred: bool = False
    """Start with the mass centre above the edge, where the pressing force has no lever arm."""
    swept: Axis
    """Parameter along each curve."""
    family: Family
    """Parameter that differs between curves."""

    def changes(self, half_width: float, clearance: float) -> dict[str, float]:
        """Return the values that differ from the figure's, for a part and a slot of these sizes."""
        centred = {"misalignment": half_width * (1.0 + clearance)} if self.centred else {}
        return {**self.held, **centred}


class CoarseGrid(Strict):
    """Coarse grid of a figure, and the values of its family that are computed."""

    points: int = Field(ge=2)
    """Number of values along each axis."""
    family: list[float] | None = Field(default=None, min_length=1)
    """Values of the figure's family that are computed; null for all."""


class ContactStiffness(Strict):
    """Figures on bases of other stiffness and damping; see contact_stiffness.py."""

    horizon: float = Field(gt=0.0)
    """Latest time τ of a run."""
    tolerance: Tolerance
    """Local error of a step."""
    stiffnesses: list[Annotated[float, Field(gt=0.0)]] = Field(min_length=1)
    """Stiffnesses k_a of the base, at the device's damping ratio."""
    damping_ratios: list[Annotated[float, Field(ge=0.0)]]
    """Damping ratios of the contact, at each stiffness of ``damped_at``."""
    damped_at: list[Annotated[float, Field(gt=0.0)]]
    """Stiffnesses k_a of the base at which the damping ratio is varied."""
    figures: dict[str, CoarseGrid] = Field(min_length=1)
    """Grid on which each figure is computed, by the figure's name."""

    @model_validator(mode="after")
    def _can_be_run(self) -> "ContactStiffness":
        for name in self.figures:
            check_name(name, GRIDDED, "figure with a grid")
        return self
