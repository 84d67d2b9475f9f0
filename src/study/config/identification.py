"""The search for the parameters that the paper leaves unstated: priors, limits, grids, effort."""

from pydantic import Field

from model.sweeps.axes import Strict, Tolerance
from study.config.base import LogRange


class Grid(Strict):
    """Number of values along the axes of a figure, by its name."""

    counts: dict[str, int | list[int]]
    """Those along the curves, along both axes of a map, or along its y and its x axis."""
    horizon: float = Field(gt=0.0)
    """Latest time τ of a run."""
    tolerance: Tolerance
    """Local error of a step."""


class Limits(Strict):
    """Limits of the regime that a set must keep besides the entries; see ``Regime``."""

    not_resting: float = Field(gt=0.0)
    """Most of the share that does not rest without vibration, in the mean over the figures."""
    not_resting_most: float = Field(gt=0.0)
    """Most of that share in the worst figure."""
    tilt: float = Field(gt=0.0)
    """Largest median tilt at alignment of a figure in radians."""
    corners: float = Field(gt=0.0, lt=1.0)
    """Least share of the aligned points that meets the four corner conditions."""
    aligned_least: float = Field(gt=0.0)
    """Least share of a curve, or of a map, that aligns."""
    aligned: dict[str, float]
    """Least share of the points of a figure up to f0 = 10 that aligns, by figure."""
    hops: dict[str, float]
    """Most of the share that lifts off, by figure."""


class Problem(Strict):
    """Unknowns that are searched, limits that a set must keep, and grids."""

    structure: dict[str, LogRange]
    """Priors of the unknowns that all figures share, log-uniform."""
    operating_points: dict[str, dict[str, LogRange]]
    """Priors of the unknowns of each figure."""
    stated: dict[str, dict[str, float]]
    """Parameters that the paper states of a figure."""
    limits: Limits
    """Limits of the regime."""
    grids: dict[str, Grid]
    """Grids by name: "rough", "coarse" and "fine"."""


class Effort(Strict):
    """One search from nothing."""

    seed: int = Field(ge=0)
    """Seed of the random draws."""
    half_width: LogRange
    """Half-widths to which it keeps."""
    limited: bool
    """Keep the limits of the regime."""
    drawn: int = Field(ge=2)
    """Structures drawn from the priors."""
    moved: int = Field(ge=0)
    """Structures made from the best ones."""
    refined: int = Field(ge=0)
    """Steps from the best one on the fine grid."""
    dearer: float = Field(default=1.0, ge=0.0)
    """Factor by which limits that are missed cost more on the fine grid."""
    conclusion: float = Field(default=1.0, ge=0.0)
    """Number of other entries that one of a numbered conclusion counts as on the fine grid."""
    entries: list[str] | None = None
    """Entries of the ledger by which it judges, the others held out; all without it."""


class Identification(Problem):
    """The search for the unstated parameters; see study/identification/."""

    searches: dict[str, Effort]
    """Searches by name."""
