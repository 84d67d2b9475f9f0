"""Trials of the integrator's accuracy on random parameter sets."""

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from model.study.config.base import Strict, check_rising, parameter_names


class Range(Strict):
    """How one parameter is drawn: log-uniform from low to high, or 0 in a share of the sets."""

    low: float = Field(gt=0.0)
    high: float
    zero: float = Field(default=0.0, ge=0.0, lt=1.0)

    @model_validator(mode="after")
    def _is_a_range(self) -> "Range":
        check_rising(("low", self.low), ("high", self.high))
        return self

    def holds(self, value: float) -> bool:
        """Whether sets with this value, or with values on both sides of it, can be drawn."""
        return self.low <= value <= self.high or (value == 0.0 and self.zero > 0.0)


class SettledTrial(Strict):
    """How many sets are drawn for the trial of settled runs, and how long they are run on."""

    sets: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)
    longer: float = Field(gt=1.0)


class Accuracy(Strict):
    """The law by which the integrator's accuracy is tried on random sets; see accuracy.py."""

    seed: int = Field(ge=0)
    horizon: float = Field(gt=0.0)
    sets: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)
    settled: SettledTrial
    ranges: Annotated[dict[str, Range], AfterValidator(parameter_names)]
