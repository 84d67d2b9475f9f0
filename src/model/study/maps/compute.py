"""Computation of a map in three steps, whole or in parts.

1. nominal: outcome and alignment duration from the nominal start, with the error of the duration;
2. unvibrated: the end without vibration, and the rest under a slow press, without errors;
3. ensemble: the outcomes from other starts, where the nominal start succeeds.

The first two are refined (lattice.py). The third uses a coarser lattice, whose nodes are all known
from the first. Separate jobs compute the parts of a map; their nodes are then put together, and the
missing ones are computed. The nodes of a map do not depend on the number of parts.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import SUCCESSES, Outcome
from model.runs.align import run_once
from model.runs.engines import engine_for, error_carrying_engine
from model.runs.errors import estimate
from model.runs.unvibrated import unvibrated_results
from model.study.maps.lattice import Bools, Floats, Ints, Lattice, Refined, corners_of, refine
from model.study.maps.plan import MapPlan
from model.study.maps.starts import ALIGNS, FAILS, NOT_TRIED, starts_inside, starts_to_try

# A cell is halved if durations in it differ by more than the larger of these.
PERIODS = 0.4  # excitation periods; a part that misses one takes one longer
SHARE = 0.1  # of the duration
_TILES = 8  # tiles along a side; a part consists of several
_AT_ONCE = 2048  # nodes between two reports of progress

Columns = Mapping[str, NDArray[Any]]
"""Quantities of m nodes by name, of shape (m,), or (m, starts) in the ensemble."""

Progress = Callable[[str, int, int], None]
"""(name of the step, starts computed so far, nodes of this wave not computed yet)."""

# Columns of a step: a value for nodes that are not computed, which also gives the type.
_NOMINAL: Columns = {
    "outcome": np.array(-1, dtype=np.int8),
    "reason": np.array(-1, dtype=np.int8),
    "tau_align": np.array(np.nan),
    "time": np.array(np.nan),  # of the end
    "tau_error": np.array(np.nan),
    "sensitive": np.array(-1, dtype=np.int8),
    "rhs_evaluations": np.array(0, dtype=np.int64),
}
_UNVIBRATED: Columns = {
    "unvibrated": np.array(-1, dtype=np.int8),
    "unvibrated_tilt": np.array(np.nan),
    "slow_tilt": np.array(np.nan),
}


def _ensemble(starts: int) -> Columns:
    return {
        "end": np.full(starts, NOT_TRIED, dtype=np.int8),
        "tau": np.full(starts, np.nan),
        "rhs_evaluations": np.zeros(starts, dtype=np.int64),
    }


# --- Computed nodes -------------------------------------------------------------------------------


class NodeStore:
    """Nodes that a step has computed: a mask of them, and columns over the whole lattice."""

    def __init__(self, lattice: Lattice, unknown: Columns) -> None:
        self.unknown = unknown
        self.computed: Bools = np.zeros(lattice.shape, dtype=np.bool_)
        self.columns = {
            name: np.full(lattice.shape + value.shape, value) for name, value in unknown.items()
        }

    def enter(self, rows: Ints, columns: Ints, values: Columns) -> None:
        """Add nodes."""
        for name, column in self.columns.items():
            column[rows, columns] = values[name]
        self.computed[rows, columns] = True

    def keep(self, computed: Bools) -> None:
        """Forget the nodes that are not ``computed``."""
        for name, column in self.columns.items():
            column[~computed] = self.unknown[name]
        self.computed &= computed

    def at(self, rows: Ints, columns: Ints) -> dict[str, NDArray[Any]]:
        """Return the columns of nodes."""
        return {name: column[rows, columns] for name, column in self.columns.items()}

    def missing(self, rows: Ints, columns: Ints) -> Iterator[tuple[Ints, Ints, int]]:
        """Yield the nodes not yet computed, some at a time, and the number of them that is left."""
        new = np.flatnonzero(~self.computed[rows, columns])
        for first in range(0, new.size, _AT_ONCE):
            some = new[first : first + _AT_ONCE]
            yield rows[some], columns[some], int(new.size - first)


class MapNodes:
    """The nodes of a map that its steps have computed; none at first."""

    def __init__(self, plan: MapPlan) -> None:
        self.nominal = NodeStore(plan.lattice, _NOMINAL)
        self.unvibrated = NodeStore(plan.lattice, _UNVIBRATED)
        self.ensemble: NodeStore | None = None
        if plan.ensemble is not None:
            self.ensemble = NodeStore(plan.ensemble_lattice, _ensemble(len(plan.starts())))

    def steps(self) -> dict[str, NodeStore]:
        """Return the nodes of every step, by its name."""
        steps = {"nominal": self.nominal, "unvibrated": self.unvibrated}
        return steps if self.ensemble is None else {**steps, "ensemble": self.ensemble}

    def trajectories(self) -> int:
        """Return the number of starts computed in all steps."""
        nodes = self.nominal.computed.sum() + self.unvibrated.computed.sum()
        return int(nodes if self.ensemble is None else nodes + self.tried().sum())

    def tried(self) -> Bools:
        """Return the starts of the ensemble that were tried, shape (rows, columns, starts)."""
        assert self.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
        return self.ensemble.columns["end"] != NOT_TRIED

    def evaluations(self) -> int:
        """Return the evaluations of the equations of motion, without the unvibrated step."""
        counted = [self.nominal] if self.ensemble is None else [self.nominal, self.ensemble]
        return sum(int(store.columns["rhs_evaluations"].sum()) for store in counted)


# --- Steps ----------------------------------------------------------------------------------------


def compute_part(plan: MapPlan, part: int = 0, parts: int = 1, *, cores: int = 1) -> MapNodes:
    """Compute the nodes of a part that follow from its own cells alone.

    Raises:
        ValueError: ``part`` is not below ``parts``.
    """
    if not 0 <= part < parts:
        raise ValueError(f"part = {part}: must be 0 to {parts - 1}")
    nodes = MapNodes(plan)
    Computation(plan, nodes, cores, part=(part, parts)).run()
    return nodes


@dataclass(frozen=True)
class Computation:
    """Compute the nodes of a map that are missing in ``nodes``, and enter them.

    After the parts of a map are put together, nodes are missing at the borders between parts. Nodes
    that the whole map does not need are removed.

    Attributes:
        plan: the map.
        nodes: nodes computed before.
        cores: number of threads.
        progress: called before nodes are computed.
        part: (part, parts) to compute one part alone, None for the whole map.
    """

    plan: MapPlan
    nodes: MapNodes
    cores: int = 1
    progress: Progress = lambda *_: None
    part: tuple[int, int] | None = None

    def run(self) -> tuple[Refined, Refined]:
        """Compute all steps; return the refined maps of the steps nominal and unvibrated."""
        nominal, unvibrated = self.nominal(), self.unvibrated()
        if self.nodes.ensemble is not None:
            self.ensemble(self.nodes.ensemble, nominal)
        return nominal, unvibrated

    def nominal(self) -> Refined:
        """Refine by the outcome and the duration from the nominal start."""
        plan, store = self.plan, self.nodes.nominal

        def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
            for some_rows, some_columns, left in store.missing(rows, columns):
                self._tell("nominal", left)
                for place, batch, settings in plan.groups(some_rows, some_columns):
                    run = engine_for(settings, cores=self.cores)
                    carrying = error_carrying_engine(settings, cores=self.cores)
                    runs = estimate(run, settings.rows(batch), settings.tolerance, carrying)
                    store.enter(some_rows[place], some_columns[place], runs.columns())
            found = store.at(rows, columns)
            return areas(found["outcome"]), duration_scale(plan, rows, columns, end_times(found))

        refined = refine(evaluate, plan.lattice, self._tiles(plan.lattice))
        store.keep(refined.computed)
        return refined

    def unvibrated(self) -> Refined:
        """Refine by the end without vibration, and by whether the part rests under a slow press."""
        plan, store = self.plan, self.nodes.unvibrated

        def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
            for some_rows, some_columns, left in store.missing(rows, columns):
                self._tell("unvibrated", left)
                for place, batch, settings in plan.groups(some_rows, some_columns):
                    controls = unvibrated_results(batch, settings, self.cores)
                    store.enter(some_rows[place], some_columns[place], controls)
            found = store.at(rows, columns)
            kind = 2 * found["unvibrated"].astype(np.int64) + np.isfinite(found["slow_tilt"])
            return kind, np.full(rows.shape, np.nan)

        lattice = replace(plan.lattice, lines=0, patch=0)
        refined = refine(evaluate, lattice, self._tiles(lattice))
        store.keep(refined.computed)
        return refined

    def ensemble(self, store: NodeStore, nominal: Refined) -> None:
        """Try starts at the nodes of the ensemble until none is left to try (starts.py)."""
        plan = self.plan
        assert plan.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
        tiles = self._tiles(plan.ensemble_lattice)
        store.computed[:] = True if tiles is None else corners_of(tiles, 1)
        kind = nominal.kind[:: plan.stride, :: plan.stride]
        fails = store.computed & (kind != plan.settings.settings.success)
        own = {"phase": plan.baseline.phase, "initial_tilt": plan.baseline.initial_tilt}
        others = np.array([start != own for start in plan.starts()])
        may_try = store.computed[:, :, None] & others
        end, phases = store.columns["end"], plan.ensemble.phases
        inside, asked = starts_inside(end.shape, phases), np.zeros(end.shape, dtype=np.bool_)
        while True:
            failed = asked & (end == FAILS)
            more = starts_to_try(failed, fails, may_try & ~asked, inside, phases)
            if not more.any():
                break
            self._tell("ensemble", int(more.any(axis=2).sum()))
            asked |= more
            self._run_starts(store, asked & (end == NOT_TRIED))
        for name, column in store.columns.items():  # remove starts that only a part had to try
            store.columns[name] = np.where(asked, column, store.unknown[name])

    def _run_starts(self, store: NodeStore, which: Bools) -> None:
        """Run the starts ``which`` at nodes, shape (rows, columns, starts), and enter them."""
        row, column, start = np.nonzero(which)
        if not start.size:
            return
        plan, starts = self.plan, self.plan.starts()
        values = {name: np.array([given[name] for given in starts])[start] for name in starts[0]}
        groups = plan.groups(plan.stride * row, plan.stride * column, **values)
        for some, batch, settings in groups:
            place = row[some], column[some], start[some]
            runs = run_once(batch, settings.quickest, cores=self.cores)
            succeeds = np.isin(runs["outcome"], SUCCESSES)
            store.columns["end"][place] = np.where(succeeds, ALIGNS, FAILS)
            store.columns["tau"][place] = np.where(succeeds, runs["tau_align"], np.nan)
            store.columns["rhs_evaluations"][place] = runs["rhs_evaluations"]

    def _tell(self, step: str, left: int) -> None:
        self.progress(step, self.nodes.trajectories(), left)

    def _tiles(self, lattice: Lattice) -> Bools | None:
        """Return a mask of the coarse cells of this part; None for the whole map.

        A part consists of square tiles from all over the map, so that parts cost alike.
        """
        if self.part is None:
            return None
        part, parts = self.part
        count = lattice.cells // lattice.coarse
        tile = np.arange(count) // max(count // _TILES, 1)
        tiles: Bools = (3 * tile[:, None] + tile) % parts == part
        return tiles


# --- What refines a map ---------------------------------------------------------------------------


def areas(outcome: NDArray[np.int8]) -> Ints:
    """Return the areas of a map: outcomes, with "horizon reached" counted as "settled"."""
    area = outcome.astype(np.int64)
    area[area == Outcome.HORIZON_REACHED] = Outcome.SETTLED
    return area


def end_times(runs: Columns) -> Floats:
    """Return the times at which parts align or leave the scene, NaN for others; shape (m,).

    Both times vary continuously over the map. A jump shows that an area too thin for the lattice is
    near.
    """
    ends: Floats = np.where(np.isin(runs["outcome"], SUCCESSES), runs["tau_align"], np.nan)
    return np.where(runs["outcome"] == Outcome.LEFT_SCENE, runs["time"], ends)


def duration_scale(plan: MapPlan, rows: Ints, columns: Ints, tau: Floats) -> Floats:
    """Return durations on a scale on which a difference of 1 halves a cell.

    The scale is linear for short durations and logarithmic for long ones. A constant force counts
    as an excitation of frequency 1.
    """
    frequency = np.empty(tau.shape)
    for place, batch, _ in plan.groups(rows, columns):
        frequency[place] = batch.values["frequency"]
    periods = tau * np.where(frequency > 0.0, frequency, 1.0) / (2.0 * math.pi)
    knee = PERIODS / SHARE  # duration from which on SHARE is the larger limit
    logarithmic = (1.0 + np.log(np.maximum(periods, knee) / knee)) / SHARE
    return np.where(periods < knee, periods / PERIODS, logarithmic)
