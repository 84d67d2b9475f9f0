"""Map of the largest misalignment ε up to which every one aligns: the error allowed by (1).

At every node of a map over two parameters, misalignments are tried from the slot's edge outward, at
equal distances, up to the first that does not align within the horizon; the interval below it is
bisected. An interval of failures narrower than the distance between trials can be missed. The map
is filled in three dimensions: inside a coarse cell, trials begin ``MARGIN`` below the value
that aligns at all its corners, and at the slot's edge only if the first of them fails.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import Field

from model.physics.parameters import Batch
from model.runs.align import run_once
from model.study.config import LARGEST_MISALIGNMENT, Study
from model.study.map_datasets import LEVEL, plane_attributes, plane_dataset
from model.study.map_parts import AllKnown, Columns, Known, Layer, refine_map
from model.study.maps import COARSE, MapPlan, plan_of
from model.study.plan import Plan
from model.study.refinement import Bools, Floats, Ints, Lattice

BISECTIONS = 5
MARGIN = 2  # trials
LIMIT: Columns = {"misalignment": np.array(np.nan), "trajectories": np.array(0, dtype=np.int32)}


class LimitPlan(Plan):
    """The map of ε as data: a plane as of any map, and the number of misalignments tried."""

    plane: MapPlan
    trials: int = Field(ge=2)

    @property
    def name(self) -> str:
        """Name of the map."""
        return self.plane.name

    @property
    def facts(self) -> dict[str, Any]:
        """The map as its sidecar states it."""
        return {**self.plane.facts, "sweep": self.identity, "trials": self.trials}

    @property
    def bounds(self) -> tuple[float, float]:
        """Misalignments beyond which the part starts on the edge, and beside the slot."""
        device = self.plane.baseline
        inner = device.half_width * device.clearance
        return inner, inner + 2.0 * device.half_width

    @property
    def tried(self) -> Floats:
        """The misalignments tried, shape (trials,), both bounds excluded."""
        inner, outer = self.bounds
        return np.linspace(inner, outer, self.trials + 2)[1:-1]

    @property
    def spacing(self) -> float:
        """Distance between trials."""
        return float(self.tried[1] - self.tried[0])

    @property
    def lattice(self) -> Lattice:
        """The lattice of ε, refined where it jumps by two trials."""
        cells = self.plane.cells
        return Lattice(cells=cells, coarse=max(cells // COARSE, 1), jump=2.0 * self.spacing)

    def layers(self, cores: int = 1) -> list[Layer]:
        """Return the layer "limit"."""

        def compute(rows: Ints, columns: Ints, known: Known) -> Columns:
            return _limits_at(self, rows, columns, known, cores)

        def compare(rows: Ints, _: Ints, found: Columns) -> tuple[Ints, Floats]:
            return np.zeros(rows.size, dtype=np.int64), found["misalignment"]

        return [Layer("limit", self.lattice, LIMIT, compute, compare)]


def limit_plan(study: Study) -> LimitPlan:
    """Return the map of ε of a study."""
    plane = study.plane(LARGEST_MISALIGNMENT)
    device = study.baseline.replace(**plane.held)
    spans = plane.x, plane.y
    resolution = study.maps.resolution.planes
    return LimitPlan(
        plane=plan_of(LARGEST_MISALIGNMENT, device, study.settings, spans, resolution, None),
        trials=study.maps.trials,
    )


def limits(
    aligns: Callable[[Ints, Floats], Bools], tried: Floats, inner: float, above: Floats
) -> tuple[Floats, Ints]:
    """Return (ε, runs) of every node, each of shape (count,).

    Args:
        aligns: (nodes by number, misalignments) -> True where a run aligns; shapes (m,).
        tried: misalignments to try, rising.
        inner: up to here the part starts above the slot, and aligns without a run.
        above: misalignment that aligns around each node, shape (count,); ``inner`` if unknown.
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


def _limits_at(plan: LimitPlan, rows: Ints, columns: Ints, known: Known, cores: int) -> Columns:
    """ε and runs of nodes, from the ``known`` ones of the coarse cells around them."""
    plane, inner = plan.plane, plan.bounds[0]
    settings = plane.settings.settings.quickest
    swept = plane.swept(rows, columns)

    def aligns(nodes: Ints, misalignment: Floats) -> Bools:
        values = {name: value[nodes] for name, value in swept.items()}
        batch = Batch.of(plane.baseline, misalignment=misalignment, **values)
        outcome = run_once(batch, settings, cores=cores)["outcome"]
        return np.asarray(outcome == settings.success)

    around = _least_around(known.columns["misalignment"], plan.lattice.coarse, rows, columns)
    found, runs = limits(aligns, plan.tried, inner, np.where(np.isnan(around), inner, around))
    return {"misalignment": found, "trajectories": runs}


def _least_around(values: Floats, coarse: int, rows: Ints, columns: Ints) -> Floats:
    """Least value at the corners of the coarse cell around each node; of two corners on its sides.

    Every part of a map that holds the node holds these corners. NaN if one is not known yet.
    """
    places = [(each // coarse * coarse, -(-each // coarse) * coarse) for each in (rows, columns)]
    return np.min([values[row, column] for row in places[0] for column in places[1]], axis=0)


def limit_dataset(plan: LimitPlan, known: AllKnown, title: str, summary: str) -> xr.Dataset:
    """Assemble the map of ε from its parts, dims (y parameter, x parameter).

    Nodes missing in ``known`` are computed and entered.
    """
    found = refine_map(plan, known)["limit"]
    runs = known["limit"].columns["trajectories"]
    variables = {
        "misalignment_max": {
            "long_name": "largest misalignment up to which every one aligns",
            "symbol": "ε",
            "comment": f"of those tried, {plan.spacing:.4g} apart, the first failure bisected "
            f"{BISECTIONS} times",
        },
        "level": LEVEL,
        "trajectories": {"long_name": "runs at this node, 0 where it was filled"},
    }
    values: dict[str, NDArray[Any]] = {
        "misalignment_max": found.value,
        "level": found.level.astype(np.int8),
        "trajectories": runs,
    }
    attributes = plane_attributes(plan.plane, "limit", title, summary)
    attributes |= {"sweep": plan.identity, "bounds": list(plan.bounds)} | limit_counts(known)
    return plane_dataset(plan.plane, variables, values, attributes, derived={"misalignment"})


def limit_counts(known: Mapping[str, Known]) -> dict[str, int]:
    """Return the counts in the sidecars of the map and its parts."""
    return {"trajectories": int(known["limit"].columns["trajectories"].sum())}
