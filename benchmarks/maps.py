"""Maps that follow their boundary against full grids: wrong nodes, trajectories and time.

Both take the same single runs from the paper's start, and a node that the refined map computes is
computed once: the full grid is those nodes and all others. Hence a node can be wrong only where it
was filled.
"""

from collections.abc import Callable
from dataclasses import dataclass
from time import process_time

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.align import run_once
from model.study.config import MAPS, Study, load_study, study_path
from model.study.maps import BESIDE, MapPlan, areas, graded, plan_of
from model.study.refinement import Bools, Evaluate, Floats, Ints, Refined, refine

_AT_ONCE = 8192


@dataclass(frozen=True)
class Comparison:
    """A refined map against the full grid; shares are of all nodes, times CPU time of one core.

    Attributes:
        figure, cells: which map, and its finest cells along a side.
        computed: share of the nodes that the refined map computes.
        failed: nodes whose run failed on the full grid, which are not compared.
        wrong: other nodes in another area than on the full grid.
        flagged: share that the refined map flags for lying beside a border.
        wrong_unflagged: wrong nodes that it does not flag.
        off: share of the aligned nodes whose duration is off by more than may differ in a cell.
        seconds_full, seconds_refined: time of either.
    """

    figure: str
    cells: int
    computed: float
    failed: int
    wrong: int
    flagged: float
    wrong_unflagged: int
    off: float
    seconds_full: float
    seconds_refined: float

    def words(self) -> str:
        """One line of the table."""
        time = self.seconds_refined / self.seconds_full
        return (
            f"{self.figure} {self.cells}x{self.cells}: {100.0 * self.computed:.2f} % of the "
            f"trajectories, {100.0 * time:.2f} % of the time; {self.wrong} wrong, of these "
            f"{self.wrong_unflagged} not flagged ({100.0 * self.flagged:.2f} % are); {self.failed} "
            f"failed on the full grid; {100.0 * self.off:.3f} % of the durations off by more than "
            "may differ in a cell"
        )


class _Nodes:
    """Nodes of one plane as they are asked for, each computed once, with the time that took."""

    def __init__(self, plan: MapPlan) -> None:
        self.plan = plan
        self.area = np.full(plan.lattice.shape, -1, dtype=np.int8)
        self.tau = np.full(plan.lattice.shape, np.nan)
        self.seconds = 0.0

    def compute(self, rows: Ints, columns: Ints) -> None:
        """Compute what is new among the nodes at ``rows``, ``columns``."""
        started = process_time()
        new = np.flatnonzero(self.area[rows, columns] < 0)
        for first in range(0, new.size, _AT_ONCE):
            some = new[first : first + _AT_ONCE]
            swept = self.plan.swept(rows[some], columns[some])
            endings = run_once(Batch.of(self.plan.baseline, **swept), self.plan.settings.settings)
            self.area[rows[some], columns[some]] = areas(endings["outcome"].astype(np.int8))
            aligned = endings["outcome"] == Outcome.ALIGNED
            self.tau[rows[some], columns[some]] = np.where(aligned, endings["tau_align"], np.nan)
        self.seconds += process_time() - started

    def evaluate(self, every: int = 1) -> Evaluate:
        """Return the function that evaluates nodes of the lattice of every n-th node."""

        def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
            place = every * rows, every * columns
            self.compute(*place)
            value = graded(self.plan, *place, self.tau[place])
            return self.area[place].astype(np.int64), value

        return evaluate


def _plan(study: Study, figure: str, cells: int) -> MapPlan:
    plane = study.plane(figure)
    device = study.parameters(figure)
    return plan_of(figure, device, study.settings, (plane.x, plane.y), cells, None)


def compare(figure: str, cells: int) -> Comparison:
    """Refine the map of ``figure``, then compute every node of it."""
    plan = _plan(load_study(study_path()), figure, cells)
    nodes = _Nodes(plan)
    nodes.compute(*(np.arange(4) for _ in range(2)))  # compiled before it is timed
    nodes = _Nodes(plan)
    started = process_time()
    refined = refine(nodes.evaluate(), plan.lattice)
    seconds_refined = process_time() - started
    nodes.compute(*np.nonzero(nodes.area < 0))
    return judge(plan, refined, nodes.area, nodes.tau, (nodes.seconds, seconds_refined))


def judge(
    plan: MapPlan,
    refined: Refined,
    area: NDArray[np.int8],
    tau: Floats,
    seconds: tuple[float, float],
) -> Comparison:
    """``refined`` against the full grid of areas and durations."""
    failed: Bools = area == Outcome.FAILED
    wrong: Bools = (refined.kind != area) & ~failed
    flagged = refined.beside(BESIDE)
    rows, columns = np.indices(plan.lattice.shape)
    difference = np.abs(refined.value - graded(plan, rows, columns, tau))
    both = np.isfinite(difference)
    return Comparison(
        figure=plan.name,
        cells=plan.cells,
        computed=float(refined.computed.mean()),
        failed=int(failed.sum()),
        wrong=int(wrong.sum()),
        flagged=float(flagged.mean()),
        wrong_unflagged=int((wrong & ~flagged).sum()),
        off=float((difference[both] > 1.0).mean()),
        seconds_full=seconds[0],
        seconds_refined=seconds[1],
    )


def costs(figure: str, finest: int, coarsest: int = 128) -> dict[int, int]:
    """Trajectories of the refined map at resolutions from ``coarsest`` to ``finest`` cells."""
    study = load_study(study_path())
    nodes = _Nodes(_plan(study, figure, finest))
    found, cells = {}, coarsest
    while cells <= finest:
        lattice = _plan(study, figure, cells).lattice
        found[cells] = int(refine(nodes.evaluate(finest // cells), lattice).computed.sum())
        cells *= 2
    return found


def slope(counts: dict[int, int]) -> float:
    """Return how trajectories grow with the cells along a side: 1 as a length, 2 as an area."""
    fitted = np.polyfit(np.log(list(counts)), np.log(list(counts.values())), 1)
    return float(fitted[0])


def report(cells: int, finest: int, say: Callable[[str], None]) -> list[dict[str, object]]:
    """Compare and cost the maps of the paper; what is measured, and said as it comes."""
    measured: list[dict[str, object]] = []
    for figure in MAPS:
        found = compare(figure, cells)
        say(found.words())
        counts = costs(figure, finest)
        grown = slope(counts)
        shown = ", ".join(f"{side}: {count:,}" for side, count in counts.items())
        say(f"{figure}: trajectories by cells along a side {shown}; slope {grown:.2f}")
        measured.append({**vars(found), "trajectories": counts, "slope": grown})
    return measured
