"""The largest misalignment ε up to which every one aligns: the allowable error of the paper's (1).

At every node of a map over two parameters, misalignments are tried from the slot's edge outward,
at equal distances, up to the first that does not align within the horizon; what lies between that
and the one before is bisected. Smaller ones are known to align as far as they were tried: an
interval of failures narrower than the distance between trials can be missed. The map is filled in
three dimensions: inside a coarse cell, what aligns at all its corners with ``MARGIN`` trials to
spare is not tried, unless the first that is tried fails.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import Field

from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.align import run_once
from model.runs.refinement import Bools, Floats, Ints, Lattice, Refined, refine
from model.study.config import LARGEST_MISALIGNMENT, Study
from model.study.map_datasets import plane_attributes, plane_coordinates
from model.study.map_parts import Columns, Compute, Known, remembered, tiles
from model.study.maps import COARSE, MapPlan, plan_of
from model.study.plan import Plan

BISECTIONS = 5
MARGIN = 2  # trials
LIMIT: Columns = {"misalignment": np.array(np.nan), "trajectories": np.array(0, dtype=np.int32)}


class LimitPlan(Plan):
    """The map of ε in numbers: the plane as of any map, and the misalignments tried at a node."""

    plane: MapPlan
    trials: int = Field(ge=2)

    @property
    def name(self) -> str:
        """As of the plane."""
        return self.plane.name

    @property
    def facts(self) -> dict[str, Any]:
        """What a sidecar says of it."""
        return {**self.plane.facts, "sweep": self.identity, "trials": self.trials}

    @property
    def bounds(self) -> tuple[float, float]:
        """Misalignments above the first the part starts on the edge, from the second beside it."""
        device = self.plane.baseline
        inner = device.half_width * device.clearance
        return inner, inner + 2.0 * device.half_width

    @property
    def tried(self) -> Floats:
        """The misalignments tried, shape (trials,), both bounds excluded."""
        inner, outer = self.bounds
        return np.linspace(inner, outer, self.trials + 2)[1:-1]

    @property
    def lattice(self) -> Lattice:
        """Where ε is computed: everywhere on the coarse cells, and where it jumps by two trials."""
        cells = self.plane.cells
        spacing = float(self.tried[1] - self.tried[0])
        return Lattice(cells=cells, coarse=max(cells // COARSE, 1), jump=2.0 * spacing)


def limit_plan(study: Study) -> LimitPlan:
    """The map of ε of a study."""
    plane = study.plane(LARGEST_MISALIGNMENT)
    device = study.baseline.replace(**plane.held)
    spans = plane.x, plane.y
    resolution = study.maps.resolution.planes
    return LimitPlan(
        plane=plan_of(LARGEST_MISALIGNMENT, device, study.settings, spans, resolution, None),
        trials=study.maps.trials,
    )


@dataclass(frozen=True)
class LimitMap:
    """ε over a plane; arrays have shape (cells + 1, cells + 1), rows along y.

    Attributes:
        plan: what it is of.
        misalignment: the largest one tried of which all smaller ones tried align.
        level: how often the coarse cell around the node was halved.
        trajectories: runs at this node, 0 where it was filled.
    """

    plan: LimitPlan
    misalignment: Floats
    level: NDArray[np.int8]
    trajectories: NDArray[np.int32]


def limits(
    aligns: Callable[[Ints, Floats], Bools], tried: Floats, inner: float, above: Floats
) -> tuple[Floats, Ints]:
    """(ε, runs) of every node, each of shape (count,).

    Args:
        aligns: whether nodes (by number) align from misalignments, all of shape (m,).
        tried: misalignments to try, rising.
        inner: where the part starts above the slot, so that it aligns without a run.
        above: what aligns around each node, shape (count,); ``inner`` where that is not known.
    """
    runs = np.zeros(above.size, dtype=np.int64)
    last, failing = np.full(above.size, inner), np.full(above.size, np.inf)

    def try_from(first: Ints) -> None:
        for index, misalignment in enumerate(tried):
            nodes = np.flatnonzero((first <= index) & np.isinf(failing))
            if nodes.size:
                works = aligns(nodes, np.full(nodes.size, misalignment))
                runs[nodes] += 1
                last[nodes[works]], failing[nodes[~works]] = misalignment, misalignment

    first = np.maximum(np.searchsorted(tried, above, "right") - MARGIN, 0)
    try_from(first)
    mistaken = (first > 0) & (failing == tried[np.minimum(first, tried.size - 1)])
    failing[mistaken] = np.inf
    try_from(np.where(mistaken, 0, tried.size))
    bounded = np.flatnonzero(np.isfinite(failing))
    for _ in range(BISECTIONS if bounded.size else 0):
        middle = 0.5 * (last[bounded] + failing[bounded])
        works = aligns(bounded, middle)
        runs[bounded] += 1
        last[bounded[works]], failing[bounded[~works]] = middle[works], middle[~works]
    return last, runs


def limit_part(plan: LimitPlan, part: int = 0, parts: int = 1) -> Known:
    """Compute the cells of one part of the map, as far as what is in them tells.

    Raises:
        ValueError: a part that is not one of ``parts``.
    """
    known = Known.nothing(plan.lattice, LIMIT)
    _refine(plan, known, tiles(plan.lattice, part, parts))
    return known


def limit_map(plan: LimitPlan, known: Known) -> LimitMap:
    """The map, from what its parts know; ``known`` gets what is missing."""
    found = _refine(plan, known)
    runs = known.columns["trajectories"]
    return LimitMap(plan, found.value, found.level.astype(np.int8), runs)


def _refine(plan: LimitPlan, known: Known, within: Bools | None = None) -> Refined:
    look_up = remembered(known, _limits_at(plan, known))

    def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        return np.zeros(rows.size, dtype=np.int64), look_up(rows, columns)["misalignment"]

    return refine(evaluate, plan.lattice, within)


def _limits_at(plan: LimitPlan, known: Known) -> Compute:
    plane, inner = plan.plane, plan.bounds[0]
    settings, device = replace(plane.settings.settings, alignment_only=True), plane.baseline

    def compute(rows: Ints, columns: Ints) -> Columns:
        swept = plane.swept(rows, columns)

        def aligns(nodes: Ints, misalignment: Floats) -> Bools:
            values = {name: value[nodes] for name, value in swept.items()}
            batch = Batch.of(device, misalignment=misalignment, **values)
            endings = run_once(batch, settings, cores=1)
            return np.asarray(endings["outcome"] == Outcome.ALIGNED)

        around = _least_around(known.columns["misalignment"], plan.lattice.coarse, rows, columns)
        found, runs = limits(aligns, plan.tried, inner, np.where(np.isnan(around), inner, around))
        return {"misalignment": found, "trajectories": runs}

    return compute


def _least_around(values: Floats, coarse: int, rows: Ints, columns: Ints) -> Floats:
    """Least of the values at the corners of the coarse cell around nodes; on its sides, of two.

    They are the same in every part of a map that holds the node. NaN at a corner not yet known.
    """
    places = [(each // coarse * coarse, -(-each // coarse) * coarse) for each in (rows, columns)]
    return np.min([values[row, column] for row in places[0] for column in places[1]], axis=0)


def limit_dataset(found: LimitMap, title: str, summary: str) -> xr.Dataset:
    """The map as an ordinary gridded dataset, dims (y parameter, x parameter)."""
    plan, plane = found.plan, found.plan.plane
    dims = (plane.y.parameter, plane.x.parameter)
    spacing = plan.tried[1] - plan.tried[0]
    about = {
        "misalignment_max": {
            "long_name": "largest misalignment up to which every one aligns",
            "symbol": "ε",
            "comment": f"of those tried, {spacing:.4g} apart, the first failure bisected "
            f"{BISECTIONS} times",
        },
        "level": {"long_name": "refinement level: how often the coarse cell was halved"},
        "trajectories": {"long_name": "runs at this node, 0 where it was filled"},
    }
    columns = dict(zip(about, (found.misalignment, found.level, found.trajectories), strict=True))
    variables = {
        name: (dims, columns[name], {"units": "1", **attributes})
        for name, attributes in about.items()
    }
    attributes = plane_attributes(plane, "limit", title, summary)
    attributes |= {"sweep": plan.identity, "bounds": list(plan.bounds)}
    attributes |= limit_counts(found.trajectories)
    return xr.Dataset(variables, plane_coordinates(plane, derived={"misalignment"}), attributes)


def limit_counts(trajectories: NDArray[np.int32]) -> dict[str, int]:
    """What the sidecars of the map and its parts count."""
    return {"trajectories": int(trajectories.sum())}
