"""Refined maps against full grids: wrong nodes, and the share of trajectories.

Both use single runs from the nominal start. The nodes of the refined map are computed first, and
the full grid adds all others. Hence only a filled node can be wrong; none may be wrong without a
flag.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.align import run_once
from model.study.config import Study, load_study, study_path
from model.study.maps.compute import areas, duration_scale, end_times
from model.study.maps.lattice import Bools, Floats, Ints, Refined, refine
from model.study.maps.plan import MapPlan, map_plan, plan_of

_AT_ONCE = 8192


@dataclass(frozen=True)
class Comparison:
    """A refined map against the full grid.

    Attributes:
        figure: name of the map.
        cells: finest cells along a side.
        computed: share of nodes that the refined map computes.
        flagged: share of nodes that it flags, beside a border or in a patch.
        failed: nodes whose run fails on the full grid; they are not compared.
        wrong: nodes in another area than on the full grid.
        wrong_unflagged: wrong nodes without a flag.
    """

    figure: str
    cells: int
    computed: float
    flagged: float
    failed: int
    wrong: int
    wrong_unflagged: int

    def __str__(self) -> str:
        return (
            f"{self.figure} {self.cells}x{self.cells}: {100.0 * self.computed:.2f} % of the "
            f"trajectories; {self.wrong} wrong, of these {self.wrong_unflagged} not flagged "
            f"({100.0 * self.flagged:.2f} % are); {self.failed} failed on the full grid"
        )


class _Nodes:
    """Nodes of one map, computed when they are asked for and kept."""

    def __init__(self, plan: MapPlan) -> None:
        self.plan = plan
        self.area = np.full(plan.lattice.shape, -1, dtype=np.int8)
        self.end = np.full(plan.lattice.shape, np.nan)  # as in ``end_times``

    def evaluate(self, rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        """Return areas of nodes, and end times on the duration scale; compute the new ones."""
        new = np.flatnonzero(self.area[rows, columns] < 0)
        for first in range(0, new.size, _AT_ONCE):
            some = rows[new[first : first + _AT_ONCE]], columns[new[first : first + _AT_ONCE]]
            batch = Batch.of(self.plan.baseline, **self.plan.swept(*some))
            endings = run_once(batch, self.plan.settings.settings)
            self.area[some] = areas(endings["outcome"].astype(np.int8))
            self.end[some] = end_times(endings)
        place = rows, columns
        return self.area[place].astype(np.int64), duration_scale(self.plan, *place, self.end[place])


def coarse_plan(study: Study, name: str, cells: int) -> MapPlan:
    """Return the map of a plane with ``cells`` finest cells along a side."""
    plan = map_plan(study, name)
    return plan_of(name, plan.baseline, study.settings, (plan.x, plan.y), cells, None)


def compare(plan: MapPlan) -> Comparison:
    """Compare a refined map with the full grid."""
    nodes = _Nodes(plan)
    refined = refine(nodes.evaluate, plan.lattice)
    nodes.evaluate(*np.nonzero(nodes.area < 0))
    return judge(plan, refined, nodes.area)


def judge(plan: MapPlan, refined: Refined, area: NDArray[np.int8]) -> Comparison:
    """Compare ``refined`` with the areas of the full grid."""
    failed: Bools = area == Outcome.FAILED
    wrong: Bools = (refined.kind != area) & ~failed
    return Comparison(
        figure=plan.name,
        cells=plan.cells,
        computed=float(refined.computed.mean()),
        flagged=float(refined.flagged.mean()),
        failed=int(failed.sum()),
        wrong=int(wrong.sum()),
        wrong_unflagged=int((wrong & ~refined.flagged).sum()),
    )


def report(cells: int, folder: Path, say: Callable[[str], None]) -> None:
    """Compare the maps of all planes; print each result, and write them to ``maps.json``."""
    study = load_study(study_path())
    found = []
    for name in study.map_names:
        found.append(compare(coarse_plan(study, name, cells)))
        say(str(found[-1]))
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps([asdict(each) for each in found], indent=1) + "\n"
    (folder / "maps.json").write_text(text, encoding="utf-8")
