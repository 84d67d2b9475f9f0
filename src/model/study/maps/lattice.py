"""Refine a map over two parameters where it changes, and fill the nodes in between.

A map lives on the nodes of one fine lattice, so that every computed node is a node of the full map.
Square cells of this lattice are halved, from coarse cells down to cells of side two, wherever the
known nodes of a closed cell differ in kind (how a run ends) or in value by more than a jump. Cells
that touch differ in size by at most a factor of two, so that all are small near a border. Of the
nodes between, those whose neighbours on both sides differ are computed. The remaining
nodes are filled from the cell that holds them.

An island (a connected set of nodes of another kind) inside a coarse cell is missed. To find those
that are long and thin, nodes half as far apart are computed on ``lines``, some rows and columns.
Once one of its nodes is known, an island is followed as far as the cells around known nodes show
more of it. Most small islands lie beside larger ones or beside the border, where cells are smaller
than the island. At last every filled node beside a computed one of another kind is computed, until
there is none: the border of whatever touches a computed node is known, also of a finger that runs
between two rows of corners.

Where cells of a given side that hold a border are dense, the border is no curve: outcomes alternate
from node to node. Such a *patch* is not halved further.

The halved cells are the smallest set that is closed under these rules. They do not depend on the
order in which nodes become known. Parts of a map are a store of nodes for the whole map.
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

WINDOW = 9  # cells along a side of the window in which those that hold a border are counted
PATCH = 0.4  # share of them above which the border is no curve; along a straight one it is a tenth
CROOKED = 0.15  # share above which nodes are flagged twice as far from the border
BESIDE = 8  # nodes; a filled node this close to another kind is flagged
AROUND = 24  # nodes; one this close to a patch is flagged as well

Evaluate = Callable[[Ints, Ints], tuple[Ints, Floats]]
"""(rows, columns) of nodes to (kinds, values), all of shape (m,); a value may be NaN."""


@dataclass(frozen=True, kw_only=True)
class Lattice:
    """The nodes of a map and the rule by which it is refined; lengths in finest cells.

    Attributes:
        cells: finest cells along a side, a power of two; the map has ``cells`` + 1 nodes a side.
        coarse: side length of a coarse cell, a power of two.
        lines: distance of the rows and columns on which more nodes are computed, a multiple of
            ``coarse``; 0 for none.
        patch: side length of the cells by which patches are found; 0 for none.
        jump: largest difference of values in a cell that is not halved.

    Raises:
        ValueError: a number that breaks its rule.
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
        """The nodes on lines that are computed in any case."""
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
        size: side length of the smallest cell that holds the node. A cell holds its interior, its
            first row and its first column; the last cells also hold the last ones.
        density: share of the cells around the node that hold a border; see ``Lattice.patch``.
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
        """The nodes of patches, where the border is no curve."""
        return self.density > PATCH

    @property
    def flagged(self) -> Bools:
        """Filled nodes that may be of another kind: near a border, or in or near a patch."""
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

        Where a corner that counts is NaN, the value at the nearest corner is taken.
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
        """Rows and columns of the filled nodes; first corner and side length of their cells."""
        rows, columns = np.nonzero(~self.computed)
        side = self.size[rows, columns]
        last = self.lattice.cells - side
        top, left = (np.minimum(each // side * side, last) for each in (rows, columns))
        return rows, columns, top, left, side

    def beside(self, distance: int) -> Bools:
        """Filled nodes with a node of another kind at most ``distance`` rows and columns away."""
        from scipy.ndimage import maximum_filter, minimum_filter  # noqa: PLC0415  (slow)

        window = 2 * distance + 1
        low, high = (each(self.kind, window) for each in (minimum_filter, maximum_filter))
        beside: Bools = (low < high) & ~self.computed
        return beside


class _Level:
    """The cells of one size: which exist, which are halved, and the extremes known in each.

    ``low`` and ``high`` have shape (2, count, count): kinds, then values. Cells that are ``kept``
    are not halved.
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
        """Enter nodes into every closed cell that holds them."""
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
        """Halve the cells whose known nodes disagree."""
        self.halved |= (self.mixed | (self.low[1] + jump < self.high[1])) & ~self.kept

    def density(self) -> Floats:
        """Return the share of mixed cells in the window around each cell."""
        from scipy.ndimage import uniform_filter  # noqa: PLC0415  (slow)

        found: Floats = uniform_filter(self.mixed.astype(np.float64), WINDOW, mode="nearest")
        return found


def _balance(levels: list[_Level]) -> None:
    """Halve cells beside cells of a quarter of their size, and note which cells exist.

    A cell may be halved before it exists: then its parent is halved as well.
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
        """Compute the ``wanted`` nodes; return False if all of them are known."""
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
        """Return the corners of the cells with sides of at least ``least``."""
        levels = (level for level in self.levels if level.size >= least)
        return np.logical_or.reduce([corners_of(level.exists, level.size) for level in levels])

    def between(self) -> Bools:
        """Return the nodes inside halved cells of side two whose neighbours on both sides differ.

        In the middle of a cell these are its corners.
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
        """Return the nodes beside a computed one that are known or filled with another kind.

        Patches have no border to follow.
        """
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
        """Keep the cells where those that hold a border are dense."""
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
        evaluate: computes nodes; called with many at a time, with each once.
        lattice: nodes and rule.
        within: coarse cells to stay in, shape (cells/coarse, cells/coarse); all by default. Nodes
            outside of them keep kind 0 and value NaN, and are not computed; nodes beside those of
            another kind are left to the whole map.
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
    """Return what holds for each node from finest ``cells``; the last ones hold the last nodes."""
    return np.pad(cells, ((0, 1), (0, 1)), "edge")


def _padded(cells: Bools, axis: int) -> Bools:
    """``cells`` with a False one before the first and after the last along an axis."""
    return np.pad(cells, [(int(each == axis),) * 2 for each in (0, 1)])


def corners_of(cells: Bools, size: int) -> Bools:
    """Return the nodes at the corners of True ``cells``, whose sides are ``size`` nodes apart."""
    nodes = np.zeros((len(cells) * size + 1,) * 2, dtype=np.bool_)
    own = nodes[::size, ::size]  # a view
    for down, right in itertools.product((0, 1), repeat=2):
        own[down : len(cells) + down, right : len(cells) + right] |= cells
    return nodes
