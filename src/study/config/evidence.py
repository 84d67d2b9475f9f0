"""Worth of the verdicts: random devices, and other assumptions than the study's."""

from typing import Any, Literal

from pydantic import Field, field_validator

from model.sweeps.axes import Strict
from model.sweeps.settings import RunSettings
from study.config.base import ParameterValues, Text
from study.config.identification import Grid


class Drawing(Strict):
    """Random draws of one kind, without words."""

    drawn: Literal["everything", "operating points", "signs"]
    """Unknowns that are drawn from the priors; or the sign with which each is off."""
    step: float = Field(default=0.0, ge=0.0, lt=1.0)
    """Share of its value by which every unknown of the study is off, up or down."""
    count: int = Field(ge=1)
    """Number of draws."""
    parts: int = Field(default=1, ge=1)
    """Number of jobs."""


class Draws(Drawing):
    """Random draws of one kind."""

    title: Text
    """Title of what is drawn."""


class Change(Strict):
    """Difference from the study, without words."""

    settings: dict[str, Any] = Field(default_factory=dict)
    """Settings of runs other than the study's."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters of all figures other than the study's."""
    inserted: bool = False
    """Count a part as aligned only if it goes in."""

    @field_validator("settings")
    @classmethod
    def _are_settings(cls, changes: dict[str, Any]) -> dict[str, Any]:
        stated = {"readings": "consistent", "horizon": 1.0, "tolerance": 1e-6}
        RunSettings.model_validate(stated | changes)
        return changes


class Assumption(Change):
    """An assumption on which the study's device is judged anew."""

    title: Text
    """The assumption in words."""


class Evidence(Strict):
    """Random devices and assumptions, judged by the claims; see study/evidence/."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    grid: Grid
    """Grid on which all of them are computed."""
    draws: dict[str, Draws] = Field(min_length=1)
    """Random draws by kind; the first are those by which a claim is weighed."""
    assumptions: dict[str, Assumption]
    """Assumptions by name."""
