"""The ensemble of a map: the nodes at which a part aligns from every start.

A node is *reliable* if it aligns from every start of the ensemble. The map already knows where the
paper's start fails: nothing is tried there. Most of the border of the reliable area is the border
of that area, so that every start is tried beside it, and few at nodes inside that are far apart.
Wherever another start fails, nodes near try that start, then the next ones in phase, of every tilt,
and nodes beside try all, until no such node is left: a third, periodic dimension in which the
border is followed. One failure settles a node, so that the starts likely to fail come first.

Hence no node beside one that is known to fail is called reliable and is not. What can be missed is
an island of nodes that fail, without a computed one among them that does.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from model.physics.parameters import Batch
from model.runs.align import run_once
from model.study.map_parts import Columns, Known, Layer
from model.study.refinement import Bools, Floats, Ints, Refined
from model.study.starts import GOES_IN

if TYPE_CHECKING:
    from model.study.maps import MapPlan

COARSE = 32  # distances along a side between the nodes inside that try starts
INSIDE = 4  # phases of which these nodes try one with each tilt
NEAR = 2  # nodes; distance to which a start that fails is tried
NOT_TRIED, FAILS, ALIGNS = -1, 0, 1


def ensemble_layer(plan: "MapPlan", cores: int) -> Layer:
    """Return the layer "ensemble": the end and the duration of every start that is tried.

    All of its nodes are known, from the paper's start at least.
    """
    count = len(plan.starts())
    unknown: Columns = {
        "end": np.full(count, NOT_TRIED, dtype=np.int8),
        "tau": np.full(count, np.nan),
        "rhs_evaluations": np.zeros(count, dtype=np.int64),
    }

    def compute(rows: Ints, columns: Ints, known: Known) -> Columns:
        return known.of(rows, columns)  # starts are tried when the nodes around are known

    def compare(rows: Ints, _: Ints, __: Columns) -> tuple[Ints, Floats]:
        return np.zeros(rows.size, dtype=np.int64), np.full(rows.size, np.nan)

    def complete(maps: Mapping[str, Refined], known: Known, tell: Callable[[int], None]) -> None:
        paper = maps["paper"].kind[:: plan.every, :: plan.every]
        fails = known.computed & (paper != plan.settings.settings.success)
        asked = _try_starts(plan, known, fails, cores, tell)
        for name, value in unknown.items():  # of parts that know less than the whole map
            known.columns[name] = np.where(asked, known.columns[name], value)

    def runs(known: Known) -> int:
        return int((known.columns["end"] != NOT_TRIED).sum())

    return Layer("ensemble", plan.ensemble_lattice, unknown, compute, compare, complete, runs)


def of_starts(tried: Columns, aligns: Bools, tau: Floats) -> tuple[Floats, Floats, Ints]:
    """Return the share of the starts tried that align, the excess of their durations, and the runs.

    The share includes the paper's start, which ``aligns`` in ``tau`` or not. The excess is that of
    the longest duration over ``tau``, at the nearest node at which starts were tried and all align.
    Each has the shape of the lattice.
    """
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415  (slow)

    runs = (tried["end"] != NOT_TRIED).sum(axis=2)
    share = (aligns + (tried["end"] == ALIGNS).sum(axis=2)) / (1 + runs)
    excess = np.fmax.reduce(tried["tau"], axis=2, initial=0.0) - tau
    unknown = (share < 1.0) | (runs == 0)
    if unknown.all():
        return share, np.zeros(share.shape), runs
    nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return share, np.maximum(excess[tuple(nearest)], 0.0), runs


def _try_starts(
    plan: "MapPlan", known: Known, paper_fails: Bools, cores: int, tell: Callable[[int], None]
) -> Bools:
    """Try starts until none is left to try; return those of the rule, as ``known``'s columns."""
    from scipy.ndimage import binary_dilation, maximum_filter  # noqa: PLC0415  (slow)

    assert plan.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
    end, phases = known.columns["end"], plan.ensemble.phases
    own = {"phase": plan.baseline.phase, "initial_tilt": plan.baseline.initial_tilt}
    papers = np.array([start == own for start in plan.starts()])
    apart = max(plan.ensemble_lattice.cells // COARSE, 1)
    inside, asked = np.zeros((2, *end.shape), dtype=np.bool_)
    inside[::apart, ::apart] = _few(inside[::apart, ::apart].shape, phases)
    while True:
        fails = asked & (end == FAILS)
        settled = paper_fails | fails.any(axis=2)
        beside = binary_dilation(settled)[:, :, None]  # along rows and columns
        open_ = (known.computed & ~settled)[:, :, None] & ~papers & ~asked
        near = maximum_filter(fails, size=(2 * NEAR + 1, 2 * NEAR + 1, 1))
        for wanted in (inside | near, _next(near, phases), beside):
            more = wanted & open_
            if more.any():
                break
        else:
            return asked
        tell(int(more.any(axis=2).sum()))
        asked |= more
        _run(plan, known, asked & (end == NOT_TRIED), cores)


def _run(plan: "MapPlan", known: Known, which: Bools, cores: int) -> None:
    """Run the starts ``which`` at nodes, and enter them into ``known``."""
    row, column, start = place = np.nonzero(which)
    if not start.size:
        return
    starts = plan.starts()
    values = {name: np.array([each[name] for each in starts])[start] for name in starts[0]}
    swept = plan.swept(plan.every * row, plan.every * column)
    settings = plan.settings.settings.quickest
    ran = run_once(Batch.of(plan.baseline, **swept, **values), settings, cores=cores)
    goes_in = np.isin(ran["outcome"], GOES_IN)
    known.columns["end"][place] = np.where(goes_in, ALIGNS, FAILS)
    known.columns["tau"][place] = np.where(goes_in, ran["tau_align"], np.nan)
    known.columns["rhs_evaluations"][place] = ran["rhs_evaluations"]


def _few(shape: tuple[int, ...], phases: int) -> Bools:
    """Return the starts that nodes inside try, shape (rows, columns, starts).

    Those of one tilt have the phases between those of the next; neighbours try others.
    """
    every = min(INSIDE, phases)
    row, column, start = np.ogrid[tuple(map(slice, shape))]
    between = max(every // 2, 1)
    phase = start % phases + between * (start // phases)
    found: Bools = (phase - row - between * column) % every == 0
    return found


def _next(fails: Bools, phases: int) -> Bools:
    """Return the starts of every tilt at the phases that fail and those next to them."""
    by_phase = fails.reshape(*fails.shape[:2], -1, phases)
    phase = by_phase.any(axis=2)
    found: Bools = np.tile(phase | np.roll(phase, 1, 2) | np.roll(phase, -1, 2), by_phase.shape[2])
    return found
