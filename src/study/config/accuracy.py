"""Trials of the integrator's accuracy on random parameter sets."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from model.sweeps.axes import Strict, parameter_names
from study.config.base import LogRange


class Range(LogRange):
    """Distribution of one parameter: log-uniform from low to high, or 0 in a share of the sets."""

    zero: float = Field(default=0.0, ge=0.0, lt=1.0)
    """Share of the sets in which the parameter is 0."""


class SettledTrial(Strict):
    """Trial of settled runs: number of random sets, and length of the continued runs."""

    sets: int = Field(ge=1, strict=False)  # from `make fuzz SETS=7` it is a text
    """Number of random sets."""
    chunks: int = Field(ge=1, le=1000)
    """Number of jobs that the sets are divided among."""
    longer: float = Field(gt=1.0)
    """Length of a continued run, in horizons."""


class Fuzz(Strict):
    """Properties of runs on random sets over the whole domain; see verification/fuzz.py."""

    scene: Literal["alignment", "insertion"] = "alignment"
    """Contacts that are modelled; the distribution of the sets depends on the scene."""
    seed: int = Field(ge=0)
    """Seed of the random draws."""
    sets: int = Field(ge=1, strict=False)  # from `make fuzz SETS=7` it is a text
    """Number of random sets."""
    sets_a_job: int = Field(ge=1)
    """Number of sets that one job tries; the profile of a cluster merges jobs."""


class Accuracy(Strict):
    """Trials of the integrator's accuracy on random sets; see verification/accuracy.py."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    horizon: float = Field(gt=0.0)
    """Latest time τ of a run."""
    sets: int = Field(ge=1)
    """Number of random sets that are compared with a tight run and the independent solution."""
    chunks: int = Field(ge=1, le=1000)
    """Number of jobs that the sets are divided among."""
    fuzz: Fuzz
    """Properties that must hold of every run."""
    settled: SettledTrial
    """Trial of the runs that end as settled."""
    ranges: Annotated[dict[str, Range], AfterValidator(parameter_names)]
    """Distribution of each parameter that is drawn, by the parameter's name."""
