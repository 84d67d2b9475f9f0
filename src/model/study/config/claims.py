"""Runs that only the claims need: the claims' own, and figures on other bases."""

from typing import Annotated

from pydantic import Field, model_validator

from model.physics.parameters import check_name
from model.study.config.base import Axis, Family, ParameterValues, Strict, Text, Tolerance
from model.study.config.figures import GRIDDED


class ClaimRun(Strict):
    """Curves that only the claims ledger reads, at the operating point of a figure.

    ``centred`` starts the part with its mass centre above the edge, where the press has no arm.
    """

    title: Text
    figure: str
    held: ParameterValues = Field(default_factory=dict)
    centred: bool = False
    swept: Axis
    family: Family

    def changes(self, half_width: float, clearance: float) -> dict[str, float]:
        """What the run holds otherwise than its figure, for a part and a slot of these sizes."""
        centred = {"misalignment": half_width * (1.0 + clearance)} if self.centred else {}
        return {**self.held, **centred}


class CoarseGrid(Strict):
    """A figure on fewer points along each axis, and on these values of its family only."""

    points: int = Field(ge=2)
    family: list[float] | None = Field(default=None, min_length=1)


class ContactStiffness(Strict):
    """Figures on bases of other stiffness and damping; see contact_stiffness.py.

    ``stiffnesses`` are tried at the device's damping ratio, ``damping_ratios`` at each of
    ``damped_at``.
    """

    horizon: float = Field(gt=0.0)
    tolerance: Tolerance
    stiffnesses: list[Annotated[float, Field(gt=0.0)]] = Field(min_length=1)
    damping_ratios: list[Annotated[float, Field(ge=0.0)]]
    damped_at: list[Annotated[float, Field(gt=0.0)]]
    figures: dict[str, CoarseGrid] = Field(min_length=1)

    @model_validator(mode="after")
    def _can_be_run(self) -> "ContactStiffness":
        for name in self.figures:
            check_name(name, GRIDDED, "figure with a grid")
        return self
