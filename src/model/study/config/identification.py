"""Identification of the parameters that the paper leaves unstated."""

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from model.physics.parameters import check_name
from model.study.config.accuracy import Range
from model.study.config.base import ParameterValues, Strict, Tolerance, parameter_names
from model.study.config.figures import COMPUTED, HISTORIES

# Searched parameters of the structure; see identification/candidate.py.
SEARCHED = (
    "half_width",
    "half_height",
    "inertia_ratio",
    "lateral_stiffness",
    "lateral_damping_ratio",
    "axial_damping_ratio",
    "tilt_damping_ratio",
)


class Pool(Strict):
    """First samples of a search: structures, and operating points tried with each of them."""

    structures: int = Field(ge=1)
    """Number of structures drawn."""
    operating_points: int = Field(ge=1)
    """Number of operating points of each figure tried with each structure."""
    chunks: int = Field(ge=1, le=1000)
    """Number of jobs that the structures are divided among."""


class Evolution(Strict):
    """One round of a search: evolution of structures, then refinement of operating points."""

    population: int = Field(ge=5)
    """Number of structures in the evolving population."""
    generations: int = Field(ge=1)
    """Number of generations."""
    trials: int = Field(ge=2)
    """Operating points of each figure tried with each structure."""
    polished: int = Field(ge=1)
    """Number of best structures whose operating points are refined."""
    passes: int = Field(ge=1)
    """Number of passes of the refinement."""
    polish: int = Field(ge=2)
    """Operating points of each figure tried in each pass."""

    @property
    def candidates(self) -> int:
        """Number of sets that the round judges."""
        evolved = self.population * (self.generations + 1) * self.trials
        return evolved + self.polished * self.passes * self.polish


Counts = dict[str, Annotated[int, Field(ge=4)]]
Ranges = Annotated[dict[str, Range], Field(min_length=1)]


class SearchLaw(Strict):
    """Searched parameters and the score of a set; see identification/candidate.py."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    horizon: float = Field(gt=0.0)
    """Latest time τ of the search's runs."""
    tolerance: Tolerance
    """Local error of a step of the search's runs, each of which is run once."""
    counts: Counts
    """Values along each axis of each figure with a grid; other such figures are not computed."""
    run_counts: dict[str, Annotated[int, Field(ge=2)]]
    """Values along the swept axis of each run of the claims that is computed."""
    finer_only: list[str]
    """Runs of the claims that are judged on the finer grids only, to make a search cheaper."""
    structure: Ranges
    """Ranges of the parameters that all figures share."""
    stated: dict[str, ParameterValues]
    """Values that the paper states of a figure's operating point, by figure."""
    operating_points: dict[str, Annotated[Ranges, AfterValidator(parameter_names)]]
    """Ranges of the unstated values of an operating point, by figure."""
    set_aside: dict[str, str]
    """Claims that do not count in the score, each with the reason."""
    required: dict[str, list[str]]
    """Claims that a figure must reproduce, by figure."""
    regime: list[str]
    """Claims on the regime, which each search weighs differently."""
    goal: float = Field(gt=0.0, lt=1.0)
    """Margin above which a larger margin adds little to the score."""

    @model_validator(mode="after")
    def _names_figures(self) -> "SearchLaw":
        for name in (*self.counts, *self.stated, *self.operating_points, *self.required):
            check_name(name, COMPUTED, "figure that is computed")
        missing = [name for name in self.operating_points if name not in (*self.counts, *HISTORIES)]
        if missing:
            raise ValueError(f"counts: missing {', '.join(missing)}")
        for name in self.structure:
            check_name(name, SEARCHED, "parameter that is searched")
        if len(self.structure) < len(SEARCHED):
            lacking = [name for name in SEARCHED if name not in self.structure]
            raise ValueError(f"structure: missing {', '.join(lacking)}")
        return self


class Start(Strict):
    """A search over all claims."""

    weight: float = Field(gt=0.0)
    """Weight of each claim on the regime in its score, in claims."""
    known: bool
    """Begin from the known sets as well as from the first samples."""


class Descent(Strict):
    """One round of the search by the aims; see identification/descent.py."""

    structures: int = Field(ge=1)
    """Number of structures tried."""
    trials: int = Field(ge=2)
    """Operating points of each figure tried with each structure."""

    @property
    def candidates(self) -> int:
        """Number of sets that the round judges."""
        return self.structures * self.trials


class Aims(Strict):
    """Aims on claims and regime of a set; see identification/front.py."""

    missing: int = Field(ge=1)
    """Most claims that are not shown, without those ``beside``."""
    beside: list[str]
    """Claims that ask what the other aims ask."""
    not_resting: float = Field(gt=0.0, le=1.0)
    """Most of the share of aligned points that do not rest unvibrated, mean over the figures."""
    not_resting_most: float = Field(gt=0.0, le=1.0)
    """The same of the worst figure."""
    tilt: float = Field(gt=0.0)
    """Most of the median tilt at alignment of the worst figure, in radians."""
    corners: float = Field(ge=0.0, lt=1.0)
    """Least share of aligned points that meet the corner conditions, of the worst figure."""
    aligned: float = Field(gt=0.0, le=1.0)
    """Least share of the points that align, of the worst curve or map."""


class Identification(Strict):
    """Identification of unstated parameters: searches, their effort, and the admissible sets."""

    law: SearchLaw
    """Parameters that are searched, and their score."""
    pool: Pool
    """First samples, under the study's variant of the equations."""
    rounds: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of each search over all claims; each is a job and continues the one before."""
    starts: Annotated[list[Start], Field(min_length=1)]
    """Searches over all claims, each with its own random draws."""
    descents: Annotated[list[Descent], Field(min_length=1)]
    """Rounds of the search by the aims, which begins from the best of those over all claims."""
    known: dict[str, dict[str, float]]
    """Sets found before, by name."""
    compared: dict[str, dict[str, float]]
    """Sets whose regime stands beside that of the study's device, by name."""
    finer: int = Field(ge=1)
    """Number of best sets judged again with three times the values along each axis."""
    refined: int = Field(ge=0)
    """Number of best of these whose operating points are chosen anew by the aims."""
    refine: int = Field(ge=2)
    """Operating points of each figure tried for that."""
    final: int = Field(ge=1)
    """Number of best of these that are judged on the study's own grids."""
    finer_each: int = Field(ge=1)
    """As ``finer``, for each search over half of the claims and for each variant."""
    half: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of each search over half of the claims."""
    splits: int = Field(ge=1)
    """Number of random halvings of the claims."""
    aims: Aims
    """Aims by which the device is chosen."""
    admissible: float = Field(ge=1.0)
    """Worst ratio to the aims of an admissible set, over the best set's."""
    reading_counts: Counts
    """As ``law.counts``, in the searches under each variant of the equations."""
    reading_rounds: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of the search under each variant of the equations."""

    @model_validator(mode="after")
    def _same_figures(self) -> "Identification":
        if set(self.reading_counts) != set(self.law.counts):
            raise ValueError("reading_counts: must name the figures that law.counts names")
        return self
