"""Stability maps: the outcome over two parameters, and its reliability.

A map gives the outcome and the alignment time from the paper's start at every node of a fine
lattice over two parameters; refinement.py chooses the nodes that are computed. The outcome near the
border depends on the phase of the excitation at touch-down and on the tilt there, which cannot be
controlled: a *reliable* device aligns within the horizon from every start of an ensemble. Which of
these are tried, on a coarser lattice, reliability.py chooses.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.engines import engine_for, error_carrying_engine
from model.runs.errors import estimate
from model.runs.unvibrated import unvibrated_results
from model.study.config.base import Axis, Span, check_plane
from model.study.config.figures import MAPS, Ensemble
from model.study.config.settings import RunSettings
from model.study.map_parts import AllKnown, Columns, Known, Layer, Progress, refine_map
from model.study.plan import Plan
from model.study.refinement import Bools, Floats, Ints, Lattice
from model.study.reliability import ensemble_layer, of_starts
from model.study.starts import GOES_IN, starts_of

if TYPE_CHECKING:
    from model.study.config.study import Study

COARSE = 64  # coarse cells along a side of a map, at least
LARGEST = 8  # side of a coarse cell, unless there are more than twice as many of them
LINES = 8  # squares along a side on whose borders more nodes are computed
PATCH = 4  # side of the cells by which patches are found
# Durations in a cell that is not halved differ by at most the larger of these.
PERIODS = 0.4  # excitation periods; a part that misses one takes one longer
SHARE = 0.1  # of the duration


class MapPlan(Plan):
    """A map as data; the hash of its JSON is its identity.

    Attributes:
        name: "fig13", ….
        parameters: every parameter, None where it is derived; varied ones have baseline values.
        settings: settings of the runs.
        x, y: the nodes along each side, cells + 1 on both; cells is a power of two.
        ensemble: the starts of a reliable device, None for none.

    Raises:
        ValueError: x and y that form no lattice, are the same parameter, or break its rule.
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
        """The held parameters, with the baseline's values of the varied ones."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def facts(self) -> dict[str, Any]:
        """The map as its sidecar states it."""
        return {"sweep": self.identity, **self.model_dump(mode="json", exclude={"name"})}

    def swept(self, rows: Ints, columns: Ints) -> dict[str, Floats]:
        """Return the varied parameters at nodes, each of shape (m,)."""
        return {
            self.x.parameter: np.array(self.x.values)[columns],
            self.y.parameter: np.array(self.y.values)[rows],
        }

    @property
    def lattice(self) -> Lattice:
        """The lattice of the outcome from the paper's start."""
        coarse = max(self.cells // (2 * COARSE), min(self.cells // COARSE, LARGEST), 1)
        patch = PATCH if coarse > PATCH else 0  # a window is then a small part of the map
        lines = max(self.cells // LINES, coarse)
        return Lattice(cells=self.cells, coarse=coarse, lines=lines, patch=patch, jump=1.0)

    @property
    def every(self) -> int:
        """Finest cells along a side of a cell of the ensemble."""
        assert self.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
        return self.cells // max(self.cells // self.ensemble.every, 1)

    @property
    def ensemble_lattice(self) -> Lattice:
        """The lattice of the ensemble, all of whose nodes are known from the paper's start."""
        return Lattice(cells=self.cells // self.every, coarse=1)

    def starts(self) -> list[dict[str, float]]:
        """Return every start of the ensemble; the first is the paper's."""
        return [] if self.ensemble is None else starts_of(self.baseline, self.ensemble)

    def layers(self, cores: int = 1) -> list[Layer]:
        """Return the layers "paper", "twin" and, with an ensemble, "ensemble"."""
        layers = [_paper_layer(self, cores), _unvibrated_layer(self, cores)]
        return layers if self.ensemble is None else [*layers, ensemble_layer(self, cores)]


def map_plan(study: "Study", name: str) -> MapPlan:
    """Return the map ``name`` of a study.

    Raises:
        ValueError: no map of that name.
    """
    plane = study.plane(name)
    resolution = study.maps.resolution
    return plan_of(
        name,
        study.baseline.replace(**plane.held),
        study.settings,
        (plane.x, plane.y),
        resolution.figures if name in MAPS else resolution.planes,
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
    """Return a map over ``spans`` (x, y) with ``resolution`` finest cells along a side.

    A map over a parameter that the ensemble varies has no ensemble.

    Raises:
        ValueError: as ``MapPlan``.
    """
    x, y = (
        Axis(parameter=each.parameter, start=each.start, stop=each.stop, count=resolution + 1)
        for each in spans
    )
    if {x.parameter, y.parameter} & {"phase", "initial_tilt"}:
        ensemble = None
    given = parameters.given()
    return MapPlan(name=name, parameters=given, settings=settings, x=x, y=y, ensemble=ensemble)


# --- Layers -------------------------------------------------------------------------------------

# Columns of a node: the placeholder of a node that is not computed, with the column's type.
PAPER: Columns = {
    "outcome": np.array(-1, dtype=np.int8),
    "reason": np.array(-1, dtype=np.int8),
    "tau_align": np.array(np.nan),
    "time": np.array(np.nan),  # of the end
    "tau_error": np.array(np.nan),
    "sensitive": np.array(-1, dtype=np.int8),
    "rhs_evaluations": np.array(0, dtype=np.int64),
}
UNVIBRATED: Columns = {
    "unvibrated": np.array(-1, dtype=np.int8),
    "unvibrated_tilt": np.array(np.nan),
    "slow_tilt": np.array(np.nan),
}


def _paper_layer(plan: MapPlan, cores: int) -> Layer:
    """The outcome and the duration from the paper's start, with the duration's error."""
    settings, base = plan.settings.settings, plan.baseline

    def compute(rows: Ints, columns: Ints, _: Known) -> Columns:
        batch = Batch.of(base, **plan.swept(rows, columns))
        run = engine_for(settings, cores=cores)
        carrying = error_carrying_engine(settings, cores=cores)
        estimates = estimate(run, settings.rows(batch), settings.tolerance, carrying)
        found = estimates.columns()
        return {name: found[name].astype(unknown.dtype) for name, unknown in PAPER.items()}

    def compare(rows: Ints, columns: Ints, found: Columns) -> tuple[Ints, Floats]:
        return areas(found["outcome"]), graded(plan, rows, columns, end_of(found))

    return Layer("paper", plan.lattice, PAPER, compute, compare)


def _unvibrated_layer(plan: MapPlan, cores: int) -> Layer:
    """The end without vibration, and the rest under a slow press, without errors."""
    settings, base = plan.settings.settings, plan.baseline

    def compute(rows: Ints, columns: Ints, _: Known) -> Columns:
        return unvibrated_results(Batch.of(base, **plan.swept(rows, columns)), settings, cores)

    def compare(rows: Ints, _: Ints, found: Columns) -> tuple[Ints, Floats]:
        kind = 2 * found["unvibrated"].astype(np.int64) + np.isfinite(found["slow_tilt"])
        return kind, np.full(rows.shape, np.nan)

    return Layer("twin", replace(plan.lattice, lines=0, patch=0), UNVIBRATED, compute, compare)


def areas(outcome: NDArray[np.int8]) -> Ints:
    """Return the areas of a map: outcomes, with "settled" and "horizon reached" as one."""
    found = outcome.astype(np.int64)
    found[found == Outcome.HORIZON_REACHED] = Outcome.SETTLED
    return found


def end_of(found: Columns) -> Floats:
    """Return the times at which parts align or leave the scene; NaN for others, shape (m,).

    Either is continuous along the plane; where it jumps, areas too thin for the lattice are near.
    """
    ends: Floats = np.where(np.isin(found["outcome"], GOES_IN), found["tau_align"], np.nan)
    return np.where(found["outcome"] == Outcome.LEFT_SCENE, found["time"], ends)


def graded(plan: MapPlan, rows: Ints, columns: Ints, tau: Floats) -> Floats:
    """Map durations to a scale on which cells are halved at 1: linear, then logarithmic.

    A constant excitation counts as one of frequency 1.
    """
    frequency = plan.swept(rows, columns).get("frequency", np.array(plan.baseline.frequency))
    periods = tau * np.where(frequency > 0.0, frequency, 1.0) / (2.0 * math.pi)
    knee = PERIODS / SHARE  # from here on the share is the larger
    logarithmic = (1.0 + np.log(np.maximum(periods, knee) / knee)) / SHARE
    return np.where(periods < knee, periods / PERIODS, logarithmic)


# --- The map ------------------------------------------------------------------------------------


def assemble(
    plan: MapPlan, known: AllKnown, *, cores: int = 1, progress: Progress = lambda *_: None
) -> dict[str, NDArray[Any]]:
    """Assemble a map from its parts; nodes missing in ``known`` are computed and entered.

    Returns:
        The variables that map_datasets.py describes, each of shape (cells + 1, cells + 1), rows
        along y. The map is the same for any parts.
    """
    refined = refine_map(plan, known, cores=cores, progress=progress)
    paper, columns = refined["paper"], known["paper"].columns
    outcome = paper.spread(columns["outcome"])
    aligns = outcome == plan.settings.settings.success
    duration = np.where(aligns, paper.filled(columns["tau_align"]), np.nan)
    sensitive = columns["sensitive"] == 1
    twin, unvibrated = refined["twin"], known["twin"].columns
    rests = {name: twin.filled(unvibrated[name]) for name in ("unvibrated_tilt", "slow_tilt")}
    reliable, share, worst = aligns, *np.full((2, *aligns.shape), np.nan)
    trajectories = paper.computed.astype(np.int32)
    if plan.ensemble is not None:
        nodes = (slice(None, None, plan.every),) * 2
        shares, excess, runs = of_starts(known["ensemble"].columns, aligns[nodes], duration[nodes])
        share = _between(np.minimum, shares, plan.every)
        worst = duration + _between(np.maximum, excess, plan.every)
        reliable = aligns & (share == 1.0)
        trajectories[nodes] += runs
    return {
        "outcome": outcome,
        "reason": paper.spread(columns["reason"]),
        "tau_align": duration,
        "tau_error": columns["tau_error"],
        "sensitive": sensitive.astype(np.int8),
        "unvibrated": twin.spread(unvibrated["unvibrated"]),
        **rests,
        "flagged": (sensitive | paper.flagged).astype(np.int8),
        "patch": paper.patch.astype(np.int8),
        "level": paper.level.astype(np.int8),
        "trajectories": trajectories,
        "reliable_share": share,
        "reliable": reliable.astype(np.int8),
        "tau_worst": np.where(reliable, worst, np.nan),
        "margin": _margin(reliable),
    }


def evaluations(known: Mapping[str, Known]) -> int:
    """Return the evaluations of the equations of motion at all known nodes."""
    counted = (each.columns for each in known.values() if "rhs_evaluations" in each.columns)
    return sum(int(columns["rhs_evaluations"].sum()) for columns in counted)


def part_counts(plan: MapPlan, known: Mapping[str, Known]) -> dict[str, int]:
    """Return the counts in the sidecar of a part: starts computed, outcomes, and evaluations."""
    paper = known["paper"]
    outcome = paper.columns["outcome"][paper.computed]
    return {
        "trajectories": sum(each.starts(known[each.name]) for each in plan.layers()),
        **{each.name.lower(): int((outcome == each).sum()) for each in Outcome},
        "sensitive": int((paper.columns["sensitive"] == 1).sum()),
        "rhs_evaluations": evaluations(known),
    }


def _margin(inside: Bools) -> Floats:
    """Distance of every node to the nearest that is not ``inside``, each side having length 1."""
    if inside.all():
        return np.full(inside.shape, np.inf)
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415  (slow)

    found: Floats = distance_transform_edt(inside, sampling=1.0 / (len(inside) - 1))
    return found


def _between(worse: np.ufunc, values: Floats, every: int) -> Floats:
    """``values`` on a lattice ``every`` times finer; between nodes the worse of its neighbours."""
    for axis in (0, 1):
        rows = np.moveaxis(values, axis, 0)
        finer = np.repeat(worse(rows[:-1], rows[1:]), every, axis=0)
        finer = np.concatenate([finer, rows[-1:]])
        finer[::every] = rows
        values = np.moveaxis(finer, 0, axis)
    return values
