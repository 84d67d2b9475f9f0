"""The largest misalignment ε up to which every one aligns: the allowable error of the paper's (1).

At every node of a map over two parameters, misalignments are tried from the slot's edge outward,
at equal distances, up to the first that does not align within the horizon; what lies between that
and the one before is bisected. Smaller ones are known to align as far as they were tried: an
interval of failures narrower than the distance between trials can be missed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from model.physics.parameters import Batch
from model.runs.batch import run_once
from model.runs.refinement import Evaluate, Floats, Ints, Lattice, refine
from model.solver.outcomes import Outcome
from model.study.config import LARGEST_MISALIGNMENT, Study
from model.study.map_datasets import plane_attributes, plane_coordinates
from model.study.maps import COARSE, MapPlan, plan_of

BISECTIONS = 5


class LimitPlan(BaseModel):
    """The map of ε in numbers: the plane as of any map, and the misalignments tried at a node."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    plane: MapPlan
    trials: int = Field(ge=2)

    @property
    def name(self) -> str:
        """As of the plane."""
        return self.plane.name

    @property
    def facts(self) -> dict[str, Any]:
        """What a sidecar says of it."""
        return {**self.plane.facts, "trials": self.trials}

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
    aligns: Callable[[Ints, Floats], NDArray[np.bool_]], tried: Floats, inner: float, count: int
) -> tuple[Floats, Ints]:
    """(ε, runs) of ``count`` nodes, each of shape (count,).

    Args:
        aligns: whether nodes (by number) align from misalignments, all of shape (m,).
        tried: misalignments to try, rising.
        inner: where the part starts above the slot, so that it aligns without a run.
        count: nodes.
    """
    runs = np.zeros(count, dtype=np.int64)
    last, failing = np.full(count, inner), np.full(count, np.inf)
    active = np.arange(count)
    for misalignment in tried:
        works = aligns(active, np.full(active.size, misalignment))
        runs[active] += 1
        last[active[works]], failing[active[~works]] = misalignment, misalignment
        active = active[works]
        if not active.size:
            break
    bounded = np.flatnonzero(np.isfinite(failing))
    for _ in range(BISECTIONS if bounded.size else 0):
        middle = 0.5 * (last[bounded] + failing[bounded])
        works = aligns(bounded, middle)
        runs[bounded] += 1
        last[bounded[works]], failing[bounded[~works]] = middle[works], middle[~works]
    return last, runs


def limit_map(
    plan: LimitPlan, *, cores: int = 1, progress: Callable[[int], None] = lambda _: None
) -> LimitMap:
    """Compute the map of ε; ``progress`` is told how many runs have been made."""
    made = np.zeros(plan.lattice.shape, dtype=np.int32)
    found = refine(_evaluate(plan, cores, made, progress), plan.lattice)
    return LimitMap(plan, found.value, found.level.astype(np.int8), made)


def _evaluate(
    plan: LimitPlan, cores: int, made: NDArray[np.int32], progress: Callable[[int], None]
) -> Evaluate:
    plane, inner = plan.plane, plan.bounds[0]
    settings, device = plane.settings.settings, plane.baseline

    def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        swept = plane.swept(rows, columns)

        def aligns(nodes: Ints, misalignment: Floats) -> NDArray[np.bool_]:
            values = {name: value[nodes] for name, value in swept.items()}
            batch = Batch.of(device, misalignment=misalignment, **values)
            endings = run_once(batch, settings, cores=cores)
            return np.asarray(endings["outcome"] == Outcome.ALIGNED)

        value, runs = limits(aligns, plan.tried, inner, rows.size)
        made[rows, columns] = runs
        progress(int(made.sum()))
        return np.zeros(rows.size, dtype=np.int64), value

    return evaluate


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
    attributes |= {"trajectories": int(found.trajectories.sum()), "bounds": list(plan.bounds)}
    return xr.Dataset(variables, plane_coordinates(plane, derived={"misalignment"}), attributes)


def limit_counts(found: LimitMap) -> dict[str, int]:
    """What its sidecar counts."""
    return {"trajectories": int(found.trajectories.sum())}
