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


class Identification(Strict):
    """Identification of unstated parameters: searches, their effort, and the admissible sets."""

    law: SearchLaw
    """Parameters that are searched, and their score."""
    pool: Pool
    """First samples, under the study's variant of the equations."""
    rounds: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of each search over all claims."""
    starts: int = Field(ge=1)
    """Number of searches over all claims, each with its own random draws."""
    known: dict[str, dict[str, float]]
    """Sets found before, from which the last of these searches starts too, by name."""
    finer: int = Field(ge=1)
    """Number of best sets judged again with three times the values along each axis."""
    final: int = Field(ge=1)
    """Number of best of these that are judged on the study's own grids."""
    finer_each: int = Field(ge=1)
    """As ``finer``, for each search over half of the claims and for each variant."""
    half: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of each search over half of the claims."""
    splits: int = Field(ge=1)
    """Number of random halvings of the claims."""
    admissible: int = Field(ge=0)
    """Claims fewer than the best set's that an admissible set may reproduce."""
    reading_counts: Counts
    """As ``law.counts``, in the searches under each variant of the equations."""
    reading_rounds: Annotated[list[Evolution], Field(min_length=1)]
    """Rounds of the search under each variant of the equations."""

    @model_validator(mode="after")
    def _same_figures(self) -> "Identification":
        if set(self.reading_counts) != set(self.law.counts):
            raise ValueError("reading_counts: must name the figures that law.counts names")
        return self
