"""Evidence beside the verdicts: random devices, other assumptions, other devices."""

from typing import Any

from pydantic import Field, field_validator

from model.sweeps.axes import Strict
from model.sweeps.settings import RunSettings
from study.config.base import ParameterValues, Text
from study.config.identification import Grid


class Assumption(Strict):
    """An assumption on which the study's device is judged anew."""

    title: Text
    """The assumption in words."""
    settings: dict[str, Any] = Field(default_factory=dict)
    """Settings of runs other than the study's."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters of all figures other than the study's."""

    @field_validator("settings")
    @classmethod
    def _are_settings(cls, changes: dict[str, Any]) -> dict[str, Any]:
        stated = {"readings": "consistent", "horizon": 1.0, "tolerance": 1e-6}
        RunSettings.model_validate(stated | changes)
        return changes


class Evidence(Strict):
    """Devices and assumptions that are judged by the list; see study/evidence/."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    grid: Grid
    """Grid on which all of them are computed."""
    random: int = Field(ge=1)
    """Number of devices drawn from the priors; their verdicts are stored, see ``make null``."""
    near: int = Field(ge=1)
    """Number of devices of which every unknown is off."""
    step: float = Field(gt=0.0, lt=1.0)
    """Share of its value by which it is off, up or down."""
    assumptions: list[Assumption]
    """Assumptions, each by itself."""
    others: dict[str, dict[str, float]]
    """Values of the unknowns of further devices, by their titles: results of searches."""
