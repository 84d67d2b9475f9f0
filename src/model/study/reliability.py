"""The ensemble of a map: the nodes at which a part aligns from every start.

A node is *reliable* if it aligns from every start of the ensemble. Few starts tell whether it is.
Every node tries some of them, neighbours others. A node that fails from none of these also tries
the starts, and those next to them in phase, from which nodes near it fail. This goes on until no
node has such a start left: a third, periodic dimension in which the border is followed as well.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch
from model.runs.align import run_once
from model.study.map_parts import Columns, Known, Layer
from model.study.refinement import Bools, Floats, Ints, Lattice, Refined
from model.study.starts import GOES_IN

if TYPE_CHECKING:
    from model.study.maps import MapPlan

COARSE = 32  # coarse cells along a side
APART = 4  # steps of the phase between the starts that every node tries
NEAR = 4  # nodes; distance to which a start that fails is tried
NOT_TRIED, FAILS, ALIGNS = -1, 0, 1


def lattice_of(cells: int) -> Lattice:
    """Return the lattice of an ensemble with ``cells`` finest cells along a side."""
    return Lattice(cells=cells, coarse=max(cells // COARSE, 1))


def ensemble_layer(plan: "MapPlan", cores: int) -> Layer:
    """Return the layer "ensemble": the end and the duration of every start that is tried."""
    assert plan.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
    starts, lattice = plan.starts(), plan.ensemble_lattice
    phases, settings = plan.ensemble.phases, plan.settings.settings.quickest
    values = {name: np.array([start[name] for start in starts]) for name in starts[0]}
    unknown: Columns = {
        "end": np.full(len(starts), NOT_TRIED, dtype=np.int8),
        "tau": np.full(len(starts), np.nan),
        "rhs_evaluations": np.zeros(len(starts), dtype=np.int64),
    }
    asked = np.zeros((*lattice.shape, len(starts)), dtype=np.bool_)  # by the map, of what is known

    def tries(rows: Ints, columns: Ints, which: Bools, found: Columns) -> None:
        """Run the starts ``which``, shape (m, starts), that are not in ``found``; enter them."""
        node, start = np.nonzero(which & (found["end"] == NOT_TRIED))
        if node.size:
            swept = plan.swept(plan.every * rows[node], plan.every * columns[node])
            varied = {name: value[start] for name, value in values.items()}
            ran = run_once(Batch.of(plan.baseline, **swept, **varied), settings, cores=cores)
            inside = np.isin(ran["outcome"], GOES_IN)
            found["end"][node, start] = np.where(inside, ALIGNS, FAILS)
            found["tau"][node, start] = np.where(inside, ran["tau_align"], np.nan)
            found["rhs_evaluations"][node, start] = ran["rhs_evaluations"]

    def compute(rows: Ints, columns: Ints, known: Known) -> Columns:
        found = known.of(rows, columns)
        tries(rows, columns, _first(rows, columns, lattice.coarse, phases, len(starts)), found)
        return found

    def compare(rows: Ints, columns: Ints, found: Columns) -> tuple[Ints, Floats]:
        asked[rows, columns] |= _first(rows, columns, lattice.coarse, phases, len(starts))
        fails = asked[rows, columns] & (found["end"] == FAILS)
        return (~fails.any(axis=1)).astype(np.int64), np.full(rows.shape, np.nan)

    def further(refined: Refined, known: Known) -> bool:
        fails = asked & (known.columns["end"] == FAILS)
        more = _near(fails, phases) & ~asked
        more &= (refined.computed & (refined.kind == 1))[:, :, None]
        rows, columns = np.nonzero(more.any(axis=2))
        if not rows.size:
            known.columns["end"][~asked] = NOT_TRIED
            known.columns["tau"][~asked] = np.nan
            known.columns["rhs_evaluations"][~asked] = 0
            return False
        asked[rows, columns] |= more[rows, columns]
        found = known.of(rows, columns)
        tries(rows, columns, more[rows, columns], found)
        known.enter(rows, columns, found)
        return True

    def count(known: Known) -> int:
        return int((known.columns["end"] != NOT_TRIED).sum())

    return Layer("ensemble", lattice, unknown, compute, compare, further, count)


def of_starts(tried: Columns) -> tuple[Floats, Floats, Ints]:
    """Return the share of the starts tried that align, the longest duration, and the runs.

    Each has the shape of the lattice. NaN where nothing was tried; the duration also where a start
    fails.
    """
    runs = (tried["end"] != NOT_TRIED).sum(axis=2)
    with np.errstate(invalid="ignore"):
        share = (tried["end"] == ALIGNS).sum(axis=2) / runs
    longest = np.where(np.isnan(tried["tau"]), -np.inf, tried["tau"]).max(axis=2)
    return share, np.where(share == 1.0, longest, np.nan), runs


def _first(rows: Ints, columns: Ints, coarse: int, phases: int, starts: int) -> Bools:
    """The starts that every node tries, shape (m, starts): phases ``APART`` steps apart.

    They begin at another phase at each node, so that neighbours together try all of them.
    """
    apart = min(APART, phases)
    first = rows + rows // coarse + (apart // 2) * (columns + columns // coarse)
    found: Bools = np.arange(starts) % phases % apart == (first % apart)[:, None]
    return found


def _near(fails: Bools, phases: int) -> Bools:
    """Starts from which a node near fails, or that are next to one in phase; as ``fails``."""
    from scipy.ndimage import maximum_filter  # noqa: PLC0415  (slow)

    by_phase = fails.reshape(*fails.shape[:2], -1, phases)
    near: NDArray[np.bool_] = maximum_filter(by_phase, size=(2 * NEAR + 1, 2 * NEAR + 1, 1, 1))
    near = near | np.roll(near, 1, axis=3) | np.roll(near, -1, axis=3)
    return near.reshape(fails.shape)
