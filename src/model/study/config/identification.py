"""The search for the parameters that the paper leaves unstated: priors, grids, aims and effort."""

from pydantic import Field, model_validator

from model.study.config.base import Strict, Text, Tolerance, check_rising


class Prior(Strict):
    """Log-uniform range of an unknown."""

    low: float = Field(gt=0.0)
    """Smallest value, > 0."""
    high: float
    """Largest value, above ``low``."""

    @model_validator(mode="after")
    def _is_a_range(self) -> "Prior":
        check_rising(("low", self.low), ("high", self.high))
        return self


class Grid(Strict):
    """Number of values along the axes of a figure or run of the claims, by its name."""

    counts: dict[str, int]
    """Those that are computed; a map has the number along both axes."""
    horizon: float = Field(gt=0.0)
    """Latest time τ of a run."""
    tolerance: Tolerance
    """Local error of a step."""


class Stage(Strict):
    """Operating points of each figure, tried on a grid."""

    grid: Text
    """Name of the grid."""
    points: int = Field(ge=1)
    """Number of operating points of each figure."""


class Pool(Strict):
    """Structures drawn from the priors, of which the best start the search."""

    structures: int = Field(ge=1)
    """Number of structures in a part."""
    parts: int = Field(ge=1)
    """Number of parts, each one job."""
    stages: list[Stage] = Field(min_length=1)
    """How a structure is judged."""


class Round(Strict):
    """A part of the search around the best structure so far."""

    step: float = Field(gt=0.0)
    """Standard deviation of the first generation, in widths of the priors on their log axes."""
    generations: int = Field(ge=1)
    """Number of generations."""
    population: int = Field(ge=4)
    """Structures in a generation."""
    stages: list[Stage] = Field(min_length=1)
    """How a structure is judged."""


class Final(Strict):
    """Judgement of the best structures on the study's own grids."""

    sets: int = Field(ge=1)
    """Number of structures."""
    stages: list[Stage] = Field(min_length=1)
    """How a structure is judged; the last grid is the study's own."""


class Aims(Strict):
    """What a set should reach besides the claims; see decision 19."""

    not_resting: float = Field(gt=0.0)
    """Most of the share that does not rest without vibration, in the mean over the figures."""
    not_resting_most: float = Field(gt=0.0)
    """Most of that share in the worst figure."""
    tilt: float = Field(gt=0.0)
    """Largest median tilt at alignment of a figure in radians."""
    corners: float = Field(gt=0.0, lt=1.0)
    """Least share of the aligned points that meets the four corner conditions."""
    aligned: float = Field(gt=0.0)
    """Least share of a curve's axis that aligns."""
    aligned_mean: dict[str, float]
    """Least share of all points of a figure that aligns, by figure."""
    aligned_most: dict[str, float]
    """Largest share of all points of a figure that aligns, by figure."""
    friction: float = Field(gt=0.0)
    """Preferred largest friction."""


class Problem(Strict):
    """What is searched, and what a set should reach."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    structure: dict[str, Prior]
    """Unknowns that all figures share."""
    operating_points: dict[str, dict[str, Prior]]
    """Unknowns of each figure."""
    stated: dict[str, dict[str, float]]
    """Parameters that the paper states of a figure."""
    aims: Aims
    """What a set should reach besides the claims."""
    set_aside: dict[str, Text]
    """Claims that the search does not pursue, with the reason."""
    grids: dict[str, Grid]
    """Grids by name, besides the study's own, "own"."""


class Identification(Problem):
    """The search for the unstated parameters; see study/identification/."""

    pool: Pool
    """Structures to start from."""
    starts: int = Field(ge=1)
    """Number of structures of the pool from which a search begins, far from each other."""
    rounds: list[Round]
    """Rounds of each search; a further round goes on where the last has ended."""
    final: Final
    """Judgement on the study's own grids."""
