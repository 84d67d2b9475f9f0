"""Maps that follow their boundary against full grids: wrong nodes, trajectories and time.

Both take the same single runs from the nominal start, and a node that the refined map computes is
computed once: the full grid is those nodes and all others. Hence a node can be wrong only where it
was filled. The ensemble of starts is compared likewise: the starts that its map tries, and all.

Besides the maps of the paper there are planes and devices drawn by a seed.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from time import process_time

import numpy as np
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.align import run_once
from model.study.config import MAPS, Map, Study, load_study, study_path
from model.study.maps.compute import Computation, MapNodes, areas, duration_scale, end_times
from model.study.maps.lattice import Bools, Evaluate, Floats, Ints, Refined, refine
from model.study.maps.plan import MapPlan, plan_of
from model.study.maps.starts import COARSE, every_start, sum_up_starts

SEED = 4105  # of the planes and devices that are drawn
SPREAD = 1.5  # largest factor by which a drawn device's values differ from the study's
_AT_ONCE = 8192
_LENGTHS = ("half_width", "misalignment", "clearance")
_TRIAL = 16  # cells along a side of the grid that tells whether a drawn plane has a border


@dataclass(frozen=True)
class Comparison:
    """A refined map against the full grid; shares are of all nodes, times CPU time of one core.

    Attributes:
        figure, cells: which map, and its finest cells along a side.
        computed: share of the nodes that the refined map computes.
        failed: nodes whose run failed on the full grid, which are not compared.
        wrong: other nodes in another area than on the full grid.
        flagged: share that the refined map flags, for lying beside a border or in a patch.
        patch: share in patches, where the border is no curve.
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
    patch: float
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
            f"{self.wrong_unflagged} not flagged ({100.0 * self.flagged:.2f} % are, "
            f"{100.0 * self.patch:.2f} % in patches); {self.failed} failed on the full grid; "
            f"{100.0 * self.off:.3f} % of the durations off by more than may differ in a cell"
        )


class _Nodes:
    """Nodes of one plane as they are asked for, each computed once, with the time that took."""

    def __init__(self, plan: MapPlan) -> None:
        self.plan = plan
        self.area = np.full(plan.lattice.shape, -1, dtype=np.int8)
        self.end = np.full(plan.lattice.shape, np.nan)  # as in ``end_times``
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
            self.end[rows[some], columns[some]] = end_times(endings)
        self.seconds += process_time() - started

    def evaluate(self, every: int = 1) -> Evaluate:
        """Return the function that evaluates nodes of the lattice of every n-th node."""

        def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
            place = every * rows, every * columns
            self.compute(*place)
            value = duration_scale(self.plan, *place, self.end[place])
            return self.area[place].astype(np.int64), value

        return evaluate


def _plan(study: Study, name: str, cells: int, device: Parameters | None = None) -> MapPlan:
    plane = study.plane(name)
    own = study.parameters(name) if isinstance(plane, Map) else study.baseline.replace(**plane.held)
    spans = plane.x, plane.y
    return plan_of(name, device or own, study.settings, spans, cells, study.maps.ensemble)


def drawn(study: Study, cells: int, count: int = 6) -> Iterator[MapPlan]:
    """Yield maps of planes of the study, in turn, for devices drawn around the study's.

    Every value of a device is multiplied by a factor up to ``SPREAD`` or divided by it, but for the
    lengths that bound each other. Devices that align nearly everywhere in the plane, or nearly
    nowhere, are drawn again.
    """
    rng = np.random.default_rng(SEED)
    names = list(study.map_names)
    for name in (names * count)[:count]:
        share = 0.0
        while not 0.05 < share < 0.95:
            own = _plan(study, name, _TRIAL).baseline
            factors = {
                each: value * math.exp(rng.uniform(-1.0, 1.0) * math.log(SPREAD))
                for each, value in own.given().items()
                if value and each not in _LENGTHS
            }
            trial = _plan(study, name, _TRIAL, own.replace(**factors))
            nodes = _Nodes(trial)
            nodes.compute(*(each.ravel() for each in np.indices(trial.lattice.shape)))
            share = float((nodes.area == Outcome.ALIGNED).mean())
        yield _plan(study, name, cells, trial.baseline)


def compare(plan: MapPlan) -> Comparison:
    """Refine a map, then compute every node of it."""
    nodes = _Nodes(plan)
    nodes.compute(*(np.arange(4) for _ in range(2)))  # compiled before it is timed
    nodes = _Nodes(plan)
    started = process_time()
    refined = refine(nodes.evaluate(), plan.lattice)
    seconds_refined = process_time() - started
    nodes.compute(*np.nonzero(nodes.area < 0))
    return judge(plan, refined, nodes.area, nodes.end, (nodes.seconds, seconds_refined))


def judge(
    plan: MapPlan,
    refined: Refined,
    area: NDArray[np.int8],
    end: Floats,
    seconds: tuple[float, float],
) -> Comparison:
    """``refined`` against the full grid of areas and of times as in ``end_times``."""
    failed: Bools = area == Outcome.FAILED
    wrong: Bools = (refined.kind != area) & ~failed
    flagged = refined.flagged
    rows, columns = np.indices(plan.lattice.shape)
    difference = np.abs(refined.value - duration_scale(plan, rows, columns, end))
    both = np.isfinite(difference) & (area == Outcome.ALIGNED)
    return Comparison(
        figure=plan.name,
        cells=plan.cells,
        computed=float(refined.computed.mean()),
        failed=int(failed.sum()),
        wrong=int(wrong.sum()),
        flagged=float(flagged.mean()),
        patch=float(refined.patch.mean()),
        wrong_unflagged=int((wrong & ~flagged).sum()),
        off=float((difference[both] > 1.0).mean()) if both.any() else 0.0,
        seconds_full=seconds[0],
        seconds_refined=seconds[1],
    )


@dataclass(frozen=True)
class Reliability:
    """The map of an ensemble against every start at every node.

    Attributes:
        figure, cells: which map, and the cells along a side of the ensemble's lattice.
        tried: share of the starts that the map tries.
        nodes: nodes of which all starts would be as many runs.
        refined: nodes of a lattice refined where all starts align, some or none; all are tried.
        reliable: share of the nodes that align from every start.
        wrong, too_good: nodes at which the map is wrong, and of these those that it calls reliable.
    """

    figure: str
    cells: int
    tried: float
    nodes: int
    refined: int
    reliable: float
    wrong: int
    too_good: int

    def words(self) -> str:
        """One line of the table."""
        return (
            f"{self.figure} ensemble {self.cells}x{self.cells}: {100.0 * self.tried:.2f} % of the "
            f"starts, as many as of {self.nodes:,} nodes ({self.refined:,} if all were tried on a "
            f"refined lattice); {100.0 * self.reliable:.1f} % reliable; {self.wrong} wrong, "
            f"{self.too_good} of them called reliable"
        )


def compare_reliability(plan: MapPlan) -> Reliability:
    """Refine the map and try the starts that it asks for, then run every start at every node."""
    nodes, starts, coarser = MapNodes(plan), plan.starts(), plan.ensemble_lattice
    assert nodes.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
    nominal = refine(_Nodes(plan).evaluate(), plan.lattice)
    Computation(plan, nodes).ensemble(nodes.ensemble, nominal)
    tried, at = nodes.ensemble.columns, (slice(None, None, plan.stride),) * 2
    aligns: Bools = nominal.kind[at] == plan.settings.settings.success
    share, _, _ = sum_up_starts(tried["end"], tried["tau"], aligns, nominal.value[at])
    settings = replace(plan.settings.settings, alignment_only=True)
    rows, columns = (plan.stride * each.ravel() for each in np.indices(coarser.shape))
    every = [
        every_start(Batch.of(plan.baseline, **plan.swept(*some)), starts, settings)["goes_in"]
        for some in zip(
            *(np.array_split(each, 1 + each.size // 256) for each in (rows, columns)), strict=True
        )
    ]
    aligned = np.concatenate(every).sum(axis=1).reshape(coarser.shape)
    reliable = aligned == len(starts)
    kind = np.where(reliable, 2, np.minimum(aligned, 1))
    lattice = replace(coarser, coarse=max(coarser.cells // COARSE, 1))
    on_lattice = refine(lambda *node: (kind[node], np.full(node[0].shape, np.nan)), lattice)
    wrong: Bools = (share == 1.0) != reliable
    runs = int(nodes.tried().sum())
    return Reliability(
        figure=plan.name,
        cells=coarser.cells,
        tried=runs / (reliable.size * len(starts)),
        nodes=round(runs / len(starts)),
        refined=int(on_lattice.computed.sum()),
        reliable=float(reliable.mean()),
        wrong=int(wrong.sum()),
        too_good=int((wrong & ~reliable).sum()),
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
    """Compare and cost maps; what is measured, and said as it comes."""
    study = load_study(study_path())
    measured: list[dict[str, object]] = []
    for plan in (*(_plan(study, figure, cells) for figure in MAPS), *drawn(study, cells)):
        found, reliability = compare(plan), compare_reliability(plan)
        say(found.words())
        say(reliability.words())
        measured.append({**asdict(found), "ensemble": asdict(reliability)})
    for figure in MAPS:
        counts = costs(figure, finest)
        shown = ", ".join(f"{side}: {count:,}" for side, count in counts.items())
        say(f"{figure}: trajectories by cells along a side {shown}; slope {slope(counts):.2f}")
        measured.append({"figure": figure, "trajectories": counts, "slope": slope(counts)})
    return measured
