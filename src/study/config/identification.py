"""The search for the parameters that the paper leaves unstated: priors, grids, aims and effort."""

from typing import Annotated

from pydantic import Field

from model.sweeps.axes import Strict, Tolerance
from study.config.base import LogRange, Text


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


class Scored(Strict):
    """Structures that are scored in stages."""

    stages: list[Stage] = Field(min_length=1)
    """Grids on which a structure is scored, one after the other."""


class Pool(Scored):
    """Structures drawn from the priors; the best of them are the first generation."""

    structures: int = Field(ge=1)
    """Number of structures in a part."""
    parts: int = Field(ge=1)
    """Number of parts, each one job."""


class Round(Scored):
    """A part of a search, which begins from the best structures of the part before."""

    generations: int = Field(ge=1)
    """Number of generations, that of the start included."""
    population: int = Field(ge=5)
    """Structures in a generation."""


class Final(Scored):
    """Scores of the best structures; the last grid is the study's own."""

    sets: int = Field(ge=1)
    """Number of structures."""


class Polish(Scored):
    """Small steps from the best structures; the last grid is the study's own."""

    sets: int = Field(ge=1)
    """Number of structures, each one job."""
    trials: int = Field(ge=1)
    """Number of steps that are tried from each."""


class HoldOut(Strict):
    """A short search on half of the figures, judged by the other half."""

    halves: dict[str, list[Text]]
    """Figures of each half, by its name."""
    start: int = Field(ge=0)
    """Number of the search, which names its third of the half-widths."""
    pool: Pool
    """Structures to start from, in one part."""
    round: Round
    """The round of the search."""
    final: Final
    """Scores of the best structures, the best of which is judged."""
    grid: Text
    """Grid of the figures that the search has not seen."""
    points: int = Field(ge=1)
    """Operating points drawn for each figure of a structure."""
    repeats: int = Field(ge=1)
    """Number of times that points are drawn for the structure found."""
    structures: int = Field(ge=1)
    """Random structures to compare with, for each of which points are drawn once."""


class Aims(Strict):
    """Aims of a set besides the claims; see decision 19."""

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
    """Unknowns that are searched, and aims that a set should reach."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    structure: dict[str, LogRange]
    """Priors of the unknowns that all figures share, log-uniform."""
    operating_points: dict[str, dict[str, LogRange]]
    """Priors of the unknowns of each figure."""
    stated: dict[str, dict[str, float]]
    """Parameters that the paper states of a figure."""
    aims: Aims
    """Aims besides the claims."""
    limits: Aims
    """The same numbers, less strict: missing these costs more."""
    set_aside: dict[str, Text]
    """Claims that the search does not pursue, with the reason."""
    grids: dict[str, Grid]
    """Grids by name, besides the study's own, "own"."""


class Identification(Problem):
    """The search for the unstated parameters; see study/identification/."""

    pool: Pool
    """Structures to start from."""
    starts: list[Annotated[int, Field(ge=0)]] = Field(min_length=1)
    """Numbers of the searches, each within a third of the half-widths: 0, 3, … in the narrowest."""
    rounds: list[Round]
    """Rounds of each search; a further round goes on where the last has ended."""
    final: Final
    """Scores on the study's own grids."""
    polish: Polish
    """Steps on the study's own grids."""
    hold_out: HoldOut
    """The search on half of the figures."""
