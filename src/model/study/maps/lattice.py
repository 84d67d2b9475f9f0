"""Refinement of a map over two parameters where it changes; nodes in between are filled.

A map consists of the nodes of one fine lattice. A node has a *kind* (how a run ends) and a value.
Square cells are halved, from coarse cells down to cells of side two, if the known nodes of a cell,
its border included, differ in kind, or in value by more than a jump. Cells that touch differ in
size by at most a factor of two, so that all cells near a border are small. In cells of side two, a
node is computed if its neighbours on both sides differ. The other nodes are filled from the cell
that contains them.

An island (a connected set of nodes of another kind) inside a coarse cell is missed. To find long
and thin ones, nodes half as far apart are computed on some rows and columns, the ``lines``. Once
one of its nodes is known, an island is followed by halving the cells around it. Most small islands
lie beside larger ones or beside a border, where cells are smaller than the island. Finally, every
filled node beside a computed node of another kind is computed, until there is none. Every area that
touches a computed node then has its exact border, also a finger between two rows of corners.

Where the cells with a border are dense, the border is no curve: outcomes alternate from node to
node. The cells of such a *patch* are not halved further.

The halved cells are the smallest set that is closed under these rules. They do not depend on the
order in which nodes become known, so that parts of a map can be computed first.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WINDOW = 9  # side, in cells, of the window in which cells with a border are counted
PATCH = 0.4  # share of cells with a border that makes a patch; along a straight border it is 0.1
CROOKED = 0.15  # share above which nodes are flagged twice as far from the border
BESIDE = 8  # distance in nodes; a filled node this close to another kind is flagged
AROUND = 24  # distance in nodes; a filled node this close to a patch is flagged

Evaluate = Callable[[Ints, Ints], tuple[Ints, Floats]]
"""(rows, columns) of nodes to (kinds, values), all of shape (m,); a value may be NaN."""


@dataclass(frozen=True, kw_only=True)
class Lattice:
    """The nodes of a map and the rules of its refinement; lengths in finest cells.

    Attributes:
        cells: finest cells along a side, a power of two; the map has ``cells`` + 1 nodes a side.
        coarse: side length of a coarse cell, a power of two.
        lines: distance of the rows and columns on which more nodes are computed, a multiple of
            ``coarse``; 0 for none.
        patch: side length of the cells by which patches are found; 0 for none.
        jump: difference of values above which a cell is halved.

    Raises:
        ValueError: a number breaks its rule.
    """

    cells: int
    coarse: int
    lines: int = 0
    patch: int = 0
    jump: float = np.inf

    def __post_init__(self) -> None:
        for name in ("cells", "coarse"):
            value = getattr(self, name)
            if value < 1 or value & (value - 1):
                raise ValueError(f"{name} = {value}: must be a power of two")
        if self.coarse > self.cells:
            raise ValueError(f"coarse = {self.coarse}: must be at most cells = {self.cells}")
        if self.lines < 0 or self.lines % self.coarse:
            raise ValueError(f"lines = {self.lines}: must be a multiple of coarse = {self.coarse}")
        if self.patch and self.patch not in self.sizes[:-1]:
            sides = ", ".join(map(str, self.sizes[:-1]))
            raise ValueError(f"patch = {self.patch}: must be 0 or the side of a cell: {sides}")

    @property
    def shape(self) -> tuple[int, int]:
        """Number of nodes (rows, columns)."""
        return self.cells + 1, self.cells + 1

    @property
    def sizes(self) -> list[int]:
        """Side lengths of cells, coarsest first."""
        return [self.coarse >> level for level in range(self.coarse.bit_length())]

    def watched(self) -> Bools:
        """Return a mask of the nodes on ``lines``, which are always computed."""
        nodes, apart = np.zeros(self.shape, dtype=np.bool_), max(self.coarse // 2, 1)
        if self.lines:
            nodes[:: self.lines, ::apart] = nodes[::apart, :: self.lines] = True
        return nodes


@dataclass(frozen=True)
class Refined:
    """A refined map; arrays have the shape of the lattice.

    Attributes:
        lattice: the lattice it was refined on.
        kind, value: of every node, computed or filled.
        computed: the nodes that were computed.
        size: side length of the smallest cell that contains the node. A cell contains its interior,
            its first row and its first column; cells at the end also their last ones.
        density: share of cells with a border among the cells around the node; see ``WINDOW``.
    """

    lattice: Lattice
    kind: Ints
    value: Floats
    computed: Bools
    size: Ints
    density: Floats

    @property
    def level(self) -> Ints:
        """Number of times the coarse cell around a node was halved."""
        return np.log2(self.lattice.coarse / self.size).astype(np.int64)

    @property
    def patch(self) -> Bools:
        """A mask of the nodes in patches."""
        return self.density > PATCH

    @property
    def flagged(self) -> Bools:
        """A mask of filled nodes that may be of another kind: near a border, in or near a patch."""
        from scipy.ndimage import maximum_filter  # noqa: PLC0415  (slow)

        near = self.beside(BESIDE) | self.beside(2 * BESIDE) & (self.density > CROOKED)
        around = maximum_filter(self.patch, 2 * AROUND + 1)
        found: Bools = (near | around) & ~self.computed
        return found

    def spread(self, column: NDArray[Any]) -> NDArray[Any]:
        """Fill ``column``, known where ``computed``, with the nearest corner of the cell."""
        full = column.copy()
        rows, columns, top, left, side = self._filled_nodes()
        down, right = 2 * (rows - top) > side, 2 * (columns - left) > side
        full[rows, columns] = column[top + side * down, left + side * right]
        return full

    def filled(self, column: Floats) -> Floats:
        """Fill ``column``, known where ``computed``, by bilinear interpolation in each cell.

        If a corner with a weight is NaN, the value of the nearest corner is taken.
        """
        full = self.spread(column)
        rows, columns, top, left, side = self._filled_nodes()
        down, right = (rows - top) / side, (columns - left) / side
        found = np.zeros(rows.size)
        for lower, farther in itertools.product((0, 1), repeat=2):
            weight = np.where(lower, down, 1.0 - down) * np.where(farther, right, 1.0 - right)
            corner = column[top + lower * side, left + farther * side]
            found += np.where(weight > 0.0, weight * corner, 0.0)
        full[rows, columns] = np.where(np.isnan(found), full[rows, columns], found)
        return full

    def _filled_nodes(self) -> tuple[Ints, Ints, Ints, Ints, Ints]:
        """Return rows and columns of filled nodes, and first corner and side of their cells."""
        rows, columns = np.nonzero(~self.computed)
        side = self.size[rows, columns]
        last = self.lattice.cells - side
        top, left = (np.minimum(each // side * side, last) for each in (rows, columns))
        return rows, columns, top, left, side

    def beside(self, distance: int) -> Bools:
        """Return the filled nodes with another kind at most ``distance`` rows and columns away."""
        from scipy.ndimage import maximum_filter, minimum_filter  # noqa: PLC0415  (slow)

        window = 2 * distance + 1
        low, high = (each(self.kind, window) for each in (minimum_filter, maximum_filter))
        beside: Bools = (low < high) & ~self.computed
        return beside


class _Level:
    """The cells of one size: masks of those that exist and are halved, and their extremes.

    ``low`` and ``high``, shape (2, count, count), are the smallest and largest known kind, then
    value. ``kept`` cells are never halved.
    """

    def __init__(self, lattice: Lattice, size: int) -> None:
        count = lattice.cells // size
        self.size = size
        self.exists, self.halved, self.kept = np.zeros((3, count, count), dtype=np.bool_)
        self.low, self.high = (np.full((2, count, count), each) for each in (np.inf, -np.inf))

    @property
    def mixed(self) -> Bools:
        """Cells whose known nodes differ in kind."""
        return self.low[0] < self.high[0]

    def learn(self, rows: Ints, columns: Ints, kinds: Ints, values: Floats) -> None:
        """Enter nodes into all cells that contain them, in the interior or on the border."""
        last = len(self.exists) - 1
        both = kinds.astype(np.float64), values
        for down, right in itertools.product((0, 1), repeat=2):
            cell = tuple(
                np.clip((each - shift) // self.size, 0, last)
                for each, shift in ((rows, down), (columns, right))
            )
            for low, high, known in zip(self.low, self.high, both, strict=True):
                np.fmin.at(low, cell, known)  # fmin and fmax skip NaN
                np.fmax.at(high, cell, known)

    def halve(self, jump: float) -> None:
        """Halve the cells whose known nodes differ in kind, or in value by more than ``jump``."""
        self.halved |= (self.mixed | (self.low[1] + jump < self.high[1])) & ~self.kept

    def density(self) -> Floats:
        """Return the share of mixed cells in the window around each cell."""
        from scipy.ndimage import uniform_filter  # noqa: PLC0415  (slow)

        found: Floats = uniform_filter(self.mixed.astype(np.float64), WINDOW, mode="nearest")
        return found


def _balance(levels: list[_Level]) -> None:
    """Halve cells that would touch cells of a quarter of their size, and update which cells exist.

    A cell may be marked as halved before it exists; this marks its parent too.
    """
    from scipy.ndimage import binary_dilation  # noqa: PLC0415  (slow)

    for coarser, level in zip(levels[-3::-1], levels[-2:0:-1], strict=True):
        count = len(coarser.halved)
        near = binary_dilation(level.halved, np.ones((3, 3)))
        coarser.halved |= near.reshape(count, 2, count, 2).any(axis=(1, 3)) & ~coarser.kept
    for level, finer in itertools.pairwise(levels):
        finer.exists = _repeated(level.exists & level.halved, 2)


class _Map:
    """A map that is being refined."""

    def __init__(self, evaluate: Evaluate, lattice: Lattice, within: Bools | None) -> None:
        self.evaluate, self.lattice = evaluate, lattice
        self.kind = np.zeros(lattice.shape, dtype=np.int64)
        self.value = np.full(lattice.shape, np.nan)
        self.computed = np.zeros(lattice.shape, dtype=np.bool_)
        self.levels = [_Level(lattice, size) for size in lattice.sizes]
        self.levels[0].exists[:] = True if within is None else within
        self.density = np.zeros(lattice.shape)

    def compute(self, wanted: Bools) -> bool:
        """Compute the ``wanted`` nodes; return False if all were known before."""
        rows, columns = np.nonzero(wanted & ~self.computed)
        if not rows.size:
            return False
        kinds, values = self.evaluate(rows, columns)
        self.kind[rows, columns], self.value[rows, columns] = kinds, values
        self.computed[rows, columns] = True
        for level in self.levels[:-1]:
            level.learn(rows, columns, kinds, values)
            level.halve(self.lattice.jump)
        _balance(self.levels)
        return True

    def corners(self, least: int) -> Bools:
        """Return the corners of the cells of size ``least`` or more."""
        levels = (level for level in self.levels if level.size >= least)
        return np.logical_or.reduce([corners_of(level.exists, level.size) for level in levels])

    def between(self) -> Bools:
        """Return the nodes in halved cells of side two whose neighbours on both sides differ.

        The neighbours of the node in the middle of a cell are the corners of the cell.
        """
        wanted = np.zeros(self.lattice.shape, dtype=np.bool_)
        cells = self.levels[-2].exists & self.levels[-2].halved
        known = self.kind[::2, ::2], self.value[::2, ::2]
        across, along = (self._differ(known, axis) for axis in (1, 0))
        wanted[::2, 1::2] = across & (_padded(cells, 0)[1:] | _padded(cells, 0)[:-1])
        wanted[1::2, ::2] = along & (_padded(cells, 1)[:, 1:] | _padded(cells, 1)[:, :-1])
        sides = across[1:] | across[:-1] | along[:, 1:] | along[:, :-1]
        wanted[1::2, 1::2] = cells & sides
        return wanted

    def beside_others(self) -> Bools:
        """Return the nodes of another kind beside a computed node, without those in patches."""
        kind, wanted = self.found().spread(self.kind), np.zeros(self.lattice.shape, dtype=np.bool_)
        for turned in (np.asarray, np.transpose):  # views
            asked, kinds, computed = (turned(each) for each in (wanted, kind, self.computed))
            differ = kinds[1:] != kinds[:-1]
            asked[1:] |= differ & computed[:-1]
            asked[:-1] |= differ & computed[1:]
        return wanted & (self.density <= PATCH)

    def _differ(self, known: tuple[Ints, Floats], axis: int) -> Bools:
        """Return where neighbours along an axis differ in kind, or in value by more than a jump."""
        kind, value = (np.diff(each, axis=axis) for each in known)
        found: Bools = (kind != 0) | (np.abs(value) > self.lattice.jump)
        return found

    def find_patches(self) -> None:
        """Find patches by the density of cells with a border, and keep their cells unhalved."""
        (level,) = (each for each in self.levels if each.size == self.lattice.patch)
        density = level.density()
        level.kept = density > PATCH
        level.halved &= ~level.kept
        _balance(self.levels)
        self.density = _nodes_of(_repeated(density, level.size))

    def found(self) -> Refined:
        """Return the map; its nodes are not filled yet."""
        size = np.full(self.lattice.shape, self.lattice.coarse, dtype=np.int64)
        for level in self.levels:
            size[_nodes_of(_repeated(level.exists, level.size))] = level.size
        size[(size == 1) & ~self.computed] = 2
        return Refined(self.lattice, self.kind, self.value, self.computed, size, self.density)


def refine(evaluate: Evaluate, lattice: Lattice, within: Bools | None = None) -> Refined:
    """Refine a map on ``lattice``.

    Args:
        evaluate: computes nodes, many in a call, and no node twice.
        lattice: the nodes and the rules.
        within: mask of the coarse cells to refine, shape (cells/coarse, cells/coarse); all by
            default. Nodes outside are not computed, and keep kind 0 and value NaN. A part does not
            follow borders node by node; the whole map does.
    """
    refined = _Map(evaluate, lattice, within)
    in_cells = corners_of(_repeated(refined.levels[0].exists, lattice.coarse), 1)
    refined.compute(refined.corners(lattice.coarse) | (in_cells & lattice.watched()))
    if lattice.patch:
        while refined.compute(refined.corners(lattice.patch)):
            pass
        refined.find_patches()
    least = min(2, lattice.coarse)
    while (
        refined.compute(refined.corners(least))
        or (lattice.coarse > 1 and refined.compute(refined.between()))
        or (within is None and refined.compute(refined.beside_others()))
    ):
        pass
    found = refined.found()
    return replace(found, kind=found.spread(found.kind), value=found.filled(found.value))


def _repeated(cells: NDArray[Any], times: int) -> NDArray[Any]:
    return np.repeat(np.repeat(cells, times, axis=0), times, axis=1)


def _nodes_of(cells: NDArray[Any]) -> NDArray[Any]:
    """Return values of nodes from those of finest ``cells``, the last row and column twice."""
    return np.pad(cells, ((0, 1), (0, 1)), "edge")


def _padded(cells: Bools, axis: int) -> Bools:
    """Return ``cells`` with a False cell added at both ends of an axis."""
    return np.pad(cells, [(int(each == axis),) * 2 for each in (0, 1)])


def corners_of(cells: Bools, size: int) -> Bools:
    """Return the nodes at the corners of True ``cells``, whose sides are ``size`` nodes apart."""
    nodes = np.zeros((len(cells) * size + 1,) * 2, dtype=np.bool_)
    own = nodes[::size, ::size]  # a view
    for down, right in itertools.product((0, 1), repeat=2):
        own[down : len(cells) + down, right : len(cells) + right] |= cells
    return nodes
