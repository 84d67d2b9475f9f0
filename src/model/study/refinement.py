"""Refine a map over two parameters where it changes, and fill the nodes in between.

A map lives on the nodes of one fine lattice, so that every computed node is a node of the full map.
Square cells of this lattice are halved, from coarse cells down to single ones, wherever the known
nodes of a closed cell differ in kind (how a run ends) or in value by more than a jump. Cells that
touch differ in size by at most a factor of two, so that all are small near a border. The remaining
nodes are filled from the cell that holds them, whose known nodes all agree.

Corners alone would miss an island inside a coarse cell. Therefore every node is computed on
``lines``, some rows and columns. An island (a connected set of nodes of another kind) is found for
certain if it reaches across a line, however thin it is, or holds a coarse cell. Once one of its
nodes is known, it is followed as far as the finest cells around known nodes show more of it. Most
small islands lie beside larger ones or beside the border, where cells are smaller than the island.

The halved cells are the smallest set that is closed under this rule. They depend neither on the
order in which nodes become known nor on the job that computed them: a map assembled
from parts equals the map made in one piece.
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

Evaluate = Callable[[Ints, Ints], tuple[Ints, Floats]]
"""(rows, columns) of nodes to (kinds, values), all of shape (m,); a value may be NaN."""


@dataclass(frozen=True, kw_only=True)
class Lattice:
    """The nodes of a map and the rule by which it is refined; lengths in finest cells.

    Attributes:
        cells: finest cells along a side, a power of two; the map has ``cells`` + 1 nodes a side.
        coarse: side length of a coarse cell, a power of two.
        lines: distance of the rows and columns that are computed whole, a multiple of ``coarse``;
            0 for none.
        jump: largest difference of values in a cell that is not halved.

    Raises:
        ValueError: a number that breaks its rule.
    """

    cells: int
    coarse: int
    lines: int = 0
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

    @property
    def shape(self) -> tuple[int, int]:
        """Number of nodes (rows, columns)."""
        return self.cells + 1, self.cells + 1

    @property
    def sizes(self) -> list[int]:
        """Side lengths of cells, coarsest first."""
        return [self.coarse >> level for level in range(self.coarse.bit_length())]

    def watched(self) -> Bools:
        """The nodes on lines."""
        nodes = np.zeros(self.shape, dtype=np.bool_)
        if self.lines:
            nodes[:: self.lines], nodes[:, :: self.lines] = True, True
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
    """

    lattice: Lattice
    kind: Ints
    value: Floats
    computed: Bools
    size: Ints

    @property
    def level(self) -> Ints:
        """Number of times the coarse cell around a node was halved."""
        return np.log2(self.lattice.coarse / self.size).astype(np.int64)

    def spread(self, column: NDArray[Any]) -> NDArray[Any]:
        """Fill ``column``, known where ``computed``, with the value at the cell's first corner."""
        full = column.copy()
        *nodes, top, left, _ = self._filled_nodes()
        full[tuple(nodes)] = column[top, left]
        return full

    def filled(self, column: Floats) -> Floats:
        """Fill ``column``, known where ``computed``, by bilinear interpolation in each cell."""
        full = column.copy()
        rows, columns, top, left, side = self._filled_nodes()
        down, right = (rows - top) / side, (columns - left) / side
        upper = (1.0 - right) * column[top, left] + right * column[top, left + side]
        lower = (1.0 - right) * column[top + side, left] + right * column[top + side, left + side]
        full[rows, columns] = (1.0 - down) * upper + down * lower
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

    ``low`` and ``high`` have shape (2, count, count): kinds, then values.
    """

    def __init__(self, lattice: Lattice, size: int) -> None:
        count = lattice.cells // size
        self.size = size
        self.exists, self.halved = np.zeros((2, count, count), dtype=np.bool_)
        self.low, self.high = (np.full((2, count, count), each) for each in (np.inf, -np.inf))

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
        self.halved |= (self.low[0] < self.high[0]) | (self.low[1] + jump < self.high[1])


def _balance(levels: list[_Level]) -> list[Bools]:
    """Halve cells beside cells of a quarter of their size; return the new cells of levels 1, 2, ….

    A cell may be halved before it exists: then its parent is halved as well.
    """
    from scipy.ndimage import binary_dilation  # noqa: PLC0415  (slow)

    for coarser, level in zip(levels[-3::-1], levels[-2:0:-1], strict=True):
        count = len(coarser.halved)
        near = binary_dilation(level.halved, np.ones((3, 3)))
        coarser.halved |= near.reshape(count, 2, count, 2).any(axis=(1, 3))
    new = []
    for level, finer in itertools.pairwise(levels):
        exists = _repeated(level.exists & level.halved, 2)
        new.append(exists & ~finer.exists)
        finer.exists |= exists
    return new


def refine(evaluate: Evaluate, lattice: Lattice, within: Bools | None = None) -> Refined:
    """Refine a map on ``lattice``.

    Args:
        evaluate: computes nodes; called with many at a time, with each once.
        lattice: nodes and rule.
        within: coarse cells to stay in, shape (cells/coarse, cells/coarse); all by default. Nodes
            outside of them keep kind 0 and value NaN, and are not computed.
    """
    kind = np.zeros(lattice.shape, dtype=np.int64)
    value = np.full(lattice.shape, np.nan)
    computed = np.zeros(lattice.shape, dtype=np.bool_)
    levels = [_Level(lattice, size) for size in lattice.sizes]
    levels[0].exists[:] = True if within is None else within
    in_cells = _corners(_repeated(levels[0].exists, lattice.coarse), 1)
    wanted = (in_cells & lattice.watched()) | _corners(levels[0].exists, lattice.coarse)
    while (wanted & ~computed).any():
        rows, columns = np.nonzero(wanted & ~computed)
        kinds, values = evaluate(rows, columns)
        kind[rows, columns], value[rows, columns] = kinds, values
        computed[rows, columns] = True
        for level in levels[:-1]:
            level.learn(rows, columns, kinds, values)
            level.halve(lattice.jump)
        for new, finer in zip(_balance(levels), levels[1:], strict=True):
            if new.any():
                wanted |= _corners(new, finer.size)
    size = np.full(lattice.shape, lattice.coarse, dtype=np.int64)
    for level in levels:
        size[np.pad(_repeated(level.exists, level.size), ((0, 1), (0, 1)), "edge")] = level.size
    found = Refined(lattice, kind, value, computed, size)
    return replace(found, kind=found.spread(kind), value=found.filled(value))


def _repeated(cells: Bools, times: int) -> Bools:
    return np.repeat(np.repeat(cells, times, axis=0), times, axis=1)


def _corners(cells: Bools, size: int) -> Bools:
    """The nodes at the corners of the True ``cells``, whose sides are ``size`` finest cells."""
    nodes = np.zeros((len(cells) * size + 1,) * 2, dtype=np.bool_)
    own = nodes[::size, ::size]  # a view
    for down, right in itertools.product((0, 1), repeat=2):
        own[down : len(cells) + down, right : len(cells) + right] |= cells
    return nodes
