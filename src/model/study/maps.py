"""Stability maps: what is computed where, and how sure it is.

A map says of every node of a fine lattice over two parameters how the part ends that starts as the
paper's does, and when it aligns; runs.refinement says which nodes are computed. Beside it stands
how sure that is. The outcome near the border depends on the phase of the excitation at touch-down
and on the tilt there, which nobody controls: *reliable* is a device that aligns within the horizon
from every start of an ensemble. That ensemble is tried on a coarser lattice, refined as well.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator
from scipy.ndimage import distance_transform_edt

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.align import align
from model.runs.refinement import Bools, Evaluate, Floats, Ints, Lattice, Refined, refine
from model.study.config import (
    LARGEST_MISALIGNMENT,
    MAPS,
    Axis,
    Ensemble,
    RunSettings,
    Span,
    Study,
    check_plane,
)
from model.study.map_parts import Columns, Compute, Known, remembered, tiles
from model.study.plan import Plan
from model.study.starts import from_every_start, starts_of

COARSE = 64  # coarse cells along a side of a map
LINES = 8  # squares, along a side, on whose border every node is computed
# By how much durations may differ within a cell that is left whole: the larger of these.
PERIODS = 0.4  # excitation periods; a part that misses one takes one longer
SHARE = 0.1  # of the duration
BESIDE = 6  # nodes; what is filled so near to another area is flagged
COARSE_ENSEMBLE = 32  # coarse cells along a side of the ensemble's lattice

Progress = Callable[[str, int, int], None]
"""(what is computed, trajectories done, nodes of this wave still to come)."""


class MapPlan(Plan):
    """One map in numbers; its JSON is its identity.

    Attributes:
        name: "fig13", ….
        parameters: every parameter, None where it is derived; varied ones hold the baseline's.
        settings: how runs are computed.
        x, y: the nodes along each side, as many along both: cells + 1, cells a power of two.
        ensemble: the starts of a reliable device, None for none.

    Raises:
        ValueError: x and y that are no lattice, are one parameter, or break its rule.
    """

    name: str
    parameters: dict[str, float | None]
    settings: RunSettings
    x: Axis
    y: Axis
    ensemble: Ensemble | None

    @model_validator(mode="after")
    def _is_a_map(self) -> "MapPlan":
        if self.x.count != self.y.count:
            raise ValueError(f"{self.x.count} and {self.y.count} nodes: must be as many")
        if self.cells & (self.cells - 1):
            raise ValueError(f"resolution = {self.cells}: must be a power of two")
        check_plane(self.baseline, self.x, self.y)
        return self

    @property
    def cells(self) -> int:
        """Finest cells along a side."""
        return self.x.count - 1

    @property
    def baseline(self) -> Parameters:
        """What is held, with the baseline's values of what is varied."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def facts(self) -> dict[str, Any]:
        """What a sidecar says of it."""
        return {"sweep": self.identity, **self.model_dump(mode="json", exclude={"name"})}

    def swept(self, rows: Ints, columns: Ints) -> dict[str, Floats]:
        """The varied parameters at nodes, each of shape (m,)."""
        return {
            self.x.parameter: np.array(self.x.values)[columns],
            self.y.parameter: np.array(self.y.values)[rows],
        }

    @property
    def lattice(self) -> Lattice:
        """The lattice of the outcome from the paper's start."""
        cells = self.cells
        coarse = max(cells // COARSE, 1)
        return Lattice(
            cells=cells,
            coarse=coarse,
            lines=max(cells // LINES, coarse),
            jump=1.0,
        )

    @property
    def ensemble_lattice(self) -> Lattice:
        """The lattice of the ensemble, coarser by ``ensemble.every``."""
        assert self.ensemble is not None  # noqa: S101  (asked for by who has one)
        cells = max(self.cells // self.ensemble.every, 1)
        return Lattice(cells=cells, coarse=max(cells // COARSE_ENSEMBLE, 1))

    def starts(self) -> list[dict[str, float]]:
        """Every start of the ensemble; the first is the paper's."""
        return [] if self.ensemble is None else starts_of(self.baseline, self.ensemble)


def map_plan(study: Study, name: str) -> MapPlan:
    """The map ``name`` of a study.

    Raises:
        ValueError: no map of outcomes of that name.
    """
    plane = study.plane(name)
    if name == LARGEST_MISALIGNMENT:
        raise ValueError(f"{name} is no map of outcomes")
    return plan_of(
        name,
        study.baseline.replace(**plane.held),
        study.settings,
        (plane.x, plane.y),
        study.maps.resolution.figures if name in MAPS else study.maps.resolution.planes,
        study.maps.ensemble,
    )


def plan_of(
    name: str,
    parameters: Parameters,
    settings: RunSettings,
    spans: tuple[Span, Span],
    resolution: int,
    ensemble: Ensemble | None,
) -> MapPlan:
    """A map over ``spans`` (x, y) with ``resolution`` finest cells along a side.

    Raises:
        ValueError: as ``MapPlan``.
    """
    x, y = (
        Axis(parameter=each.parameter, start=each.start, stop=each.stop, count=resolution + 1)
        for each in spans
    )
    varied = {x.parameter, y.parameter}
    if ensemble is not None and varied & {"phase", "initial_tilt"}:
        ensemble = None  # what the ensemble varies is varied by the map
    return MapPlan(
        name=name,
        parameters=parameters.given(),
        settings=settings,
        x=x,
        y=y,
        ensemble=ensemble,
    )


# --- What has been computed ---------------------------------------------------------------------

# What is kept of a node, by name: a value that stands for "not computed", with its type.
PAPER: Columns = {
    "outcome": np.array(-1, dtype=np.int8),
    "reason": np.array(-1, dtype=np.int8),
    "tau_align": np.array(np.nan),
    "tau_error": np.array(np.nan),
    "sensitive": np.array(-1, dtype=np.int8),
    "rhs_evaluations": np.array(0, dtype=np.int64),
}
ENSEMBLE: Columns = {
    "aligned": np.array(-1, dtype=np.int16),
    "tau_worst": np.array(np.nan),
    "rhs_evaluations": np.array(0, dtype=np.int64),
}


@dataclass(frozen=True)
class Work:
    """A map as far as it has been computed: from the paper's start, and the ensemble's."""

    plan: MapPlan
    paper: Known
    ensemble: Known | None

    @classmethod
    def nothing(cls, plan: MapPlan) -> "Work":
        """A map of which nothing is computed."""
        ensemble = None
        if plan.ensemble is not None:
            ensemble = Known.nothing(plan.ensemble_lattice, ENSEMBLE)
        return cls(plan, Known.nothing(plan.lattice, PAPER), ensemble)

    @property
    def known(self) -> dict[str, Known]:
        """What is known, by name of the start."""
        every = {"paper": self.paper, "ensemble": self.ensemble}
        return {name: known for name, known in every.items() if known is not None}

    @property
    def trajectories(self) -> int:
        """Starts computed; from the paper's each is run at least twice, for its error."""
        found = int(self.paper.computed.sum())
        if self.ensemble is not None:
            found += int(self.ensemble.computed.sum()) * len(self.plan.starts())
        return found


def paper_start(plan: MapPlan, cores: int) -> Compute:
    """How nodes are computed from the start of the paper, each with its error."""
    settings, base = plan.settings.settings, plan.baseline

    def compute(rows: Ints, columns: Ints) -> Columns:
        found = align(Batch.of(base, **plan.swept(rows, columns)), settings, cores=cores)
        return {name: getattr(found, name) for name in PAPER}

    return compute


def ensemble_starts(plan: MapPlan, cores: int) -> Compute:
    """How nodes are computed from every start of the ensemble, one run each."""
    settings, starts = plan.settings.settings, plan.starts()
    every = plan.cells // plan.ensemble_lattice.cells

    def compute(rows: Ints, columns: Ints) -> Columns:
        swept = plan.swept(every * rows, every * columns)
        found = from_every_start(plan.baseline, swept, starts, settings, cores)
        return {
            "aligned": found.aligned.sum(axis=1),
            "tau_worst": found.tau_worst,
            "rhs_evaluations": found.rhs_evaluations,
        }

    return compute


def areas(outcome: NDArray[np.int8]) -> Ints:
    """The areas of a map: outcomes, of which settled and still moving by the horizon are one."""
    found = outcome.astype(np.int64)
    found[found == Outcome.HORIZON_REACHED] = Outcome.SETTLED
    return found


def graded(plan: MapPlan, rows: Ints, columns: Ints, tau: Floats) -> Floats:
    """Durations on a scale on which 1 is how much they may differ: linear, then logarithmic.

    A constant excitation counts as of frequency 1.
    """
    frequency = plan.swept(rows, columns).get("frequency", np.array(plan.baseline.frequency))
    periods = tau * np.where(frequency > 0.0, frequency, 1.0) / (2.0 * math.pi)
    knee = PERIODS / SHARE  # from here on the share is the larger
    logarithmic = (1.0 + np.log(np.maximum(periods, knee) / knee)) / SHARE
    return np.where(periods < knee, periods / PERIODS, logarithmic)


def _paper_areas(plan: MapPlan, look_up: Compute) -> Evaluate:
    def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        found = look_up(rows, columns)
        return areas(found["outcome"]), graded(plan, rows, columns, found["tau_align"])

    return evaluate


def _ensemble_areas(plan: MapPlan, look_up: Compute) -> Evaluate:
    """Nodes from which all starts align, none, or some."""
    count = len(plan.starts())

    def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        aligned = look_up(rows, columns)["aligned"]
        kind = np.where(aligned == count, 2, np.where(aligned == 0, 0, 1))
        return kind, np.full(rows.shape, np.nan)

    return evaluate


def compute_part(
    plan: MapPlan,
    part: int = 0,
    parts: int = 1,
    *,
    cores: int = 1,
    progress: Progress = lambda *_: None,
) -> Work:
    """Compute the cells of one part of a map, as far as what is in them tells.

    Raises:
        ValueError: a part that is not one of ``parts``.
    """
    work = Work.nothing(plan)
    _refine(work, cores, progress, lambda lattice: tiles(lattice, part, parts))
    return work


def _refine(
    work: Work,
    cores: int,
    progress: Progress,
    within: Callable[[Lattice], Bools | None] = lambda _: None,
) -> tuple[Refined, Refined | None]:
    """Refine a map, computing what ``work`` does not hold yet."""
    plan = work.plan

    def note(words: str) -> Callable[[int], None]:
        return lambda left: progress(words, work.trajectories, left)

    look_up = remembered(work.paper, paper_start(plan, cores), note("outcomes"))
    paper = refine(_paper_areas(plan, look_up), plan.lattice, within(plan.lattice))
    if work.ensemble is None:
        return paper, None
    look_up = remembered(work.ensemble, ensemble_starts(plan, cores), note("reliability"))
    lattice = plan.ensemble_lattice
    return paper, refine(_ensemble_areas(plan, look_up), lattice, within(lattice))


# --- The map ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class StabilityMap:
    """A map and how sure it is; every array has shape (cells + 1, cells + 1), rows along y.

    Attributes:
        plan: what it is of.
        outcome, reason, tau_align: from the paper's start, computed or filled. A duration is
            interpolated between nodes, within ``PERIODS`` or ``SHARE``.
        tau_error: where computed, NaN elsewhere.
        sensitive: where computed, a start displaced by the tolerance ends elsewhere; else 0.
        flagged: the outcome may be another: sensitive, or filled at most ``BESIDE`` nodes from
            another area.
        computed: whether the node was computed from the paper's start, or filled.
        level: how often the coarse cell around the node was halved.
        trajectories: computed at this node, those of the ensemble included.
        reliable_share: share of the ensemble's starts that align; NaN without an ensemble.
        reliable: whether all do, and the paper's.
        tau_worst: longest duration from these starts where reliable, NaN elsewhere.
        margin: distance to the nearest node that is not reliable, along straight lines with each
            axis' range as unit; infinite if there is none on the map.
    """

    plan: MapPlan
    outcome: NDArray[np.int8]
    reason: NDArray[np.int8]
    tau_align: Floats
    tau_error: Floats
    sensitive: NDArray[np.int8]
    flagged: NDArray[np.int8]
    computed: Bools
    level: NDArray[np.int8]
    trajectories: NDArray[np.int32]
    reliable_share: Floats
    reliable: NDArray[np.int8]
    tau_worst: Floats
    margin: Floats
    rhs_evaluations: int


def assemble(work: Work, *, cores: int = 1, progress: Progress = lambda *_: None) -> StabilityMap:
    """The map, from what its parts have computed; ``work`` gets what is missing.

    From its parts those cells are missing that show at a border between two of them. The map is the
    same whatever the parts.
    """
    plan = work.plan
    paper, ensemble = _refine(work, cores, progress)
    columns = work.paper.columns
    outcome = paper.spread(columns["outcome"])
    tau = paper.filled(columns["tau_align"])
    sensitive = columns["sensitive"] == 1
    aligns = outcome == Outcome.ALIGNED
    share, worst = _ensemble_on(plan, work.ensemble, ensemble)
    reliable = aligns & (share == 1.0) if ensemble is not None else aligns
    trajectories = work.paper.computed.astype(np.int32)
    evaluations = int(columns["rhs_evaluations"].sum())
    if work.ensemble is not None:
        every = plan.cells // plan.ensemble_lattice.cells
        trajectories[::every, ::every] += len(plan.starts()) * work.ensemble.computed
        evaluations += int(work.ensemble.columns["rhs_evaluations"].sum())
    return StabilityMap(
        plan=plan,
        outcome=outcome,
        reason=paper.spread(columns["reason"]),
        tau_align=np.where(aligns, tau, np.nan),
        tau_error=columns["tau_error"],
        sensitive=sensitive.astype(np.int8),
        flagged=(sensitive | paper.beside(BESIDE)).astype(np.int8),
        computed=paper.computed,
        level=paper.level.astype(np.int8),
        trajectories=trajectories,
        reliable_share=share,
        reliable=reliable.astype(np.int8),
        tau_worst=np.where(reliable, worst, np.nan),
        margin=_margin(reliable),
        rhs_evaluations=evaluations,
    )


def _margin(inside: Bools) -> Floats:
    """Distance of every node to the nearest that is not ``inside``, each side having length 1."""
    if inside.all():
        return np.full(inside.shape, np.inf)
    found: Floats = distance_transform_edt(inside, sampling=1.0 / (len(inside) - 1))
    return found


def _ensemble_on(
    plan: MapPlan, known: Known | None, refined: Refined | None
) -> tuple[Floats, Floats]:
    """Share and worst duration on the map's lattice; between nodes tried the worst counts."""
    if known is None or refined is None:
        nothing = np.full(plan.lattice.shape, np.nan)
        return nothing, nothing
    share = refined.filled(known.columns["aligned"] / len(plan.starts()))
    worst = refined.filled(known.columns["tau_worst"])
    every = plan.cells // plan.ensemble_lattice.cells
    return _between(np.minimum, share, every), _between(np.maximum, worst, every)


def _between(worse: np.ufunc, values: Floats, every: int) -> Floats:
    """``values`` on a lattice ``every`` times finer; between nodes the worse of its neighbours."""
    for axis in (0, 1):
        rows = np.moveaxis(values, axis, 0)
        finer = np.repeat(worse(rows[:-1], rows[1:]), every, axis=0)
        finer = np.concatenate([finer, rows[-1:]])
        finer[::every] = rows
        values = np.moveaxis(finer, 0, axis)
    return values
