"""Identification of the parameters that the paper leaves unstated."""

from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from model.physics.parameters import check_name
from model.study.config.accuracy import Range
from model.study.config.base import ParameterValues, Strict, Tolerance, parameter_names
from model.study.config.figures import COMPUTED, HISTORIES

# What is searched of the structure; see identification/candidate.py.
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
    """The first samples of a search: structures, and operating points tried with each of them."""

    structures: int = Field(ge=1)
    operating_points: int = Field(ge=1)
    chunks: int = Field(ge=1, le=1000)


class Evolution(Strict):
    """How far a search is carried on from its first samples.

    A population of structures evolves; with each structure ``trials`` operating points of every
    figure are tried. Then, with the ``polished`` best structures, ``polish`` more in each of
    ``passes``.
    """

    population: int = Field(ge=5)
    generations: int = Field(ge=1)
    trials: int = Field(ge=2)
    polished: int = Field(ge=1)
    passes: int = Field(ge=1)
    polish: int = Field(ge=2)


Counts = dict[str, Annotated[int, Field(ge=4)]]
Ranges = Annotated[dict[str, Range], Field(min_length=1)]


class SearchLaw(Strict):
    """What is searched, and what is looked at; see identification/candidate.py.

    Attributes:
        seed: of every draw.
        horizon: latest time of the search's runs.
        tolerance: of the search's runs, each of which is run once.
        counts: values along each axis of a figure with a grid; other figures are not computed.
        run_counts: values along the axis of each of the claims' own runs that are computed.
        structure: ranges of what all figures share.
        stated: what the paper says of a figure's operating point.
        operating_points: ranges of what it leaves open, by figure.
        set_aside: claims that do not count in the score, with the reason.
        required: claims that a figure must show, by figure.
        goal: margin from which more of it is worth little.
    """

    seed: int = Field(ge=0)
    horizon: float = Field(gt=0.0)
    tolerance: Tolerance
    counts: Counts
    run_counts: dict[str, Annotated[int, Field(ge=2)]]
    structure: Ranges
    stated: dict[str, ParameterValues]
    operating_points: dict[str, Annotated[Ranges, AfterValidator(parameter_names)]]
    set_aside: dict[str, str]
    required: dict[str, list[str]]
    goal: float = Field(gt=0.0, lt=1.0)

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
    """How unstated parameters are identified, and how much is spent on it.

    Attributes:
        law: what is searched.
        pool: the first samples under the study's reading.
        rounds: of each search over all claims.
        starts: searches over all claims, which draw differently.
        known: sets found before, by unknown, that the last of these sets out from as well.
        finer: how many of the best are judged again, with three times the values along each axis;
            of these are the admissible sets.
        final: how many of the best of these are judged on the study's own grids, where the one that
            shows most is the study's device.
        finer_each: how many of each search over half of the claims, and of each reading's.
        half: rounds of each search over half of the claims.
        splits: how often the claims are halved.
        admissible: how many claims fewer than the best an admissible set may reproduce.
        reading_counts: as the law's, in the searches under each reading.
        reading_rounds: of each reading's search, the consistent one's again.
    """

    law: SearchLaw
    pool: Pool
    rounds: Annotated[list[Evolution], Field(min_length=1)]
    starts: int = Field(ge=1)
    known: dict[str, dict[str, float]]
    finer: int = Field(ge=1)
    final: int = Field(ge=1)
    finer_each: int = Field(ge=1)
    half: Annotated[list[Evolution], Field(min_length=1)]
    splits: int = Field(ge=1)
    admissible: int = Field(ge=0)
    reading_counts: Counts
    reading_rounds: Annotated[list[Evolution], Field(min_length=1)]

    @model_validator(mode="after")
    def _same_figures(self) -> "Identification":
        if set(self.reading_counts) != set(self.law.counts):
            raise ValueError("reading_counts: must name the figures that law.counts names")
        return self
