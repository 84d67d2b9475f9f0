"""A map over two parameters, computed where it changes and filled in between.

The map lives on the nodes of one fine lattice, so that every node that is computed is a node of the
full map. Squares of this lattice are halved, from coarse cells down to single ones, wherever the
nodes known in a closed square do not agree: in kind (how a run ends) or in value by more than a
jump. Squares that touch differ in size by at most a factor of two, so that all are small near a
border. Nodes in between are filled from the square that holds them, whose known nodes all agree.

What corners alone would miss, an island inside a coarse cell, is met by ``lines``: rows and columns
of which every node is computed. An island (a connected set of nodes of another kind) is therefore
found for certain where it reaches across a line, however thin it is, and where it holds a square of
a coarse cell's size. Once one of its nodes is known, it is followed as far as the finest cells
around known nodes show more of it. Small islands stand beside larger ones and beside the border
more often than elsewhere; there the squares are smaller than the island.

The squares that are halved are the smallest set that is closed under this rule. They depend neither
on the order in which nodes become known nor on who computed them: a map assembled from parts is
the map made in one piece.
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
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
    """The nodes of a map and the rule by which it is refined; numbers of finest cells.

    Attributes:
        cells: finest cells along a side, a power of two; the map has ``cells`` + 1 nodes a side.
        coarse: length of a coarse cell's side, a power of two.
        lines: distance of the rows and columns that are computed whole, a multiple of ``coarse``;
            0 for none.
        jump: largest difference of values in a cell that is left whole.

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
        lattice: what it was made on.
        kind, value: of every node, computed or filled.
        computed: the nodes that were computed.
        size: side length of the smallest cell that holds the node.
    """

    lattice: Lattice
    kind: Ints
    value: Floats
    computed: Bools
    size: Ints

    @property
    def level(self) -> Ints:
        """How often the coarse cell around a node was halved."""
        return np.log2(self.lattice.coarse / self.size).astype(np.int64)

    def spread(self, column: NDArray[Any]) -> NDArray[Any]:
        """``column``, known where ``computed``; in between as at the first corner of the cell."""
        return _spread(column, self.computed, self.size)

    def filled(self, column: Floats) -> Floats:
        """``column``, known where ``computed``, interpolated in between (bilinear in each cell)."""
        return _interpolated(column, self.computed, self.size)

    def beside(self, distance: int) -> Bools:
        """Filled nodes with a node of another kind at most ``distance`` rows and columns away."""
        low, high = self.kind, self.kind
        for axis in (0, 1):
            low = _windowed(np.minimum, low, distance, axis)
            high = _windowed(np.maximum, high, distance, axis)
        return (low < high) & ~self.computed


def _windowed(extreme: np.ufunc, values: Ints, distance: int, axis: int) -> Ints:
    """``extreme`` over the nodes at most ``distance`` away along ``axis``."""
    rows = np.moveaxis(values, axis, 0)
    found = rows.copy()
    for shift in range(1, distance + 1):
        extreme(found[shift:], rows[:-shift], out=found[shift:])
        extreme(found[:-shift], rows[shift:], out=found[:-shift])
    return np.moveaxis(found, 0, axis)


class _Level:
    """The cells of one size: which are there, which are halved, and what is known in each."""

    def __init__(self, lattice: Lattice, size: int) -> None:
        count = lattice.cells // size
        self.size = size
        self.there = np.zeros((count, count), dtype=np.bool_)
        self.halved = np.zeros((count, count), dtype=np.bool_)
        self.least = np.full((count, count), np.iinfo(np.int64).max)
        self.most = np.full((count, count), np.iinfo(np.int64).min)
        self.lowest = np.full((count, count), np.inf)
        self.highest = np.full((count, count), -np.inf)

    def learn(self, rows: Ints, columns: Ints, kinds: Ints, values: Floats) -> None:
        """Enter nodes into every closed cell that holds them."""
        last = len(self.there) - 1
        known = ~np.isnan(values)
        for row in (rows // self.size, (rows - 1) // self.size):
            for column in (columns // self.size, (columns - 1) // self.size):
                cell = np.clip(row, 0, last), np.clip(column, 0, last)
                np.minimum.at(self.least, cell, kinds)
                np.maximum.at(self.most, cell, kinds)
                valued = cell[0][known], cell[1][known]
                np.minimum.at(self.lowest, valued, values[known])
                np.maximum.at(self.highest, valued, values[known])

    def halve(self, jump: float) -> None:
        """Halve the cells in which nodes disagree."""
        self.halved |= self.least < self.most
        self.halved |= self.lowest + jump < self.highest


def _balance(levels: list[_Level]) -> list[Bools]:
    """Halve what touches cells of a quarter of its size; the cells of levels 1, 2, … that are new.

    A cell may be halved before it is there: then its parent is halved as well.
    """
    for coarser, level in zip(levels[-3::-1], levels[-2:0:-1], strict=True):
        coarser.halved |= _parents(_dilated(level.halved))
    new = []
    for level, finer in itertools.pairwise(levels):
        there = _repeated(level.there & level.halved, 2)
        new.append(there & ~finer.there)
        finer.there |= there
    return new


def _dilated(cells: Bools) -> Bools:
    """The True ``cells`` and all that touch them."""
    found = cells.copy()
    found[1:] |= cells[:-1]
    found[:-1] |= cells[1:]
    wider = found.copy()
    wider[:, 1:] |= found[:, :-1]
    wider[:, :-1] |= found[:, 1:]
    return wider


def _parents(cells: Bools) -> Bools:
    """The cells of twice the size that hold the True ``cells``."""
    return cells[::2, ::2] | cells[::2, 1::2] | cells[1::2, ::2] | cells[1::2, 1::2]


def refine(
    evaluate: Evaluate,
    lattice: Lattice,
    within: Bools | None = None,
) -> Refined:
    """The map of ``evaluate`` on ``lattice``.

    Args:
        evaluate: computes nodes; called with many at a time, with each once.
        lattice: nodes and rule.
        within: coarse cells to stay in, shape (cells/coarse, cells/coarse); all by default. Nodes
            outside of them are left at kind 0, value NaN, not computed.
    """
    kind = np.zeros(lattice.shape, dtype=np.int64)
    value = np.full(lattice.shape, np.nan)
    computed = np.zeros(lattice.shape, dtype=np.bool_)
    levels = [_Level(lattice, size) for size in lattice.sizes]
    levels[0].there[:] = True if within is None else within
    wanted = _touching(levels[0].there, lattice.coarse) & lattice.watched()
    wanted |= _corners(levels[0].there, lattice.coarse)
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
    size = _sizes(levels, lattice)
    return Refined(
        lattice=lattice,
        kind=_spread(kind, computed, size),
        value=_interpolated(value, computed, size),
        computed=computed,
        size=size,
    )


def _repeated(cells: Bools, times: int) -> Bools:
    return np.repeat(np.repeat(cells, times, axis=0), times, axis=1)


def _corners(cells: Bools, size: int) -> Bools:
    """The nodes at the corners of the True ``cells``."""
    nodes = np.zeros((len(cells) * size + 1,) * 2, dtype=np.bool_)
    own = nodes[::size, ::size]  # a view
    for down in (0, 1):
        for right in (0, 1):
            own[down : len(cells) + down, right : len(cells) + right] |= cells
    return nodes


def _touching(cells: Bools, size: int) -> Bools:
    """The nodes in or on the border of the True ``cells``."""
    inside = _repeated(cells, size)
    nodes = np.zeros((len(inside) + 1,) * 2, dtype=np.bool_)
    for down in (0, 1):
        for right in (0, 1):
            nodes[down : len(inside) + down, right : len(inside) + right] |= inside
    return nodes


def _sizes(levels: list[_Level], lattice: Lattice) -> Ints:
    """Side length of the smallest cell there that holds each node, as ``_holding`` has it."""
    size = np.full(lattice.shape, lattice.coarse, dtype=np.int64)
    for level in levels:
        size[np.pad(_repeated(level.there, level.size), ((0, 1), (0, 1)), "edge")] = level.size
    return size


def _holding(missing: Bools, size: Ints) -> Iterator[tuple[Bools, Ints, Ints, Ints, Ints, int]]:
    """For each size: the missing nodes there, their rows and columns, and their cell's corner.

    A cell holds its interior, its first row and its first column; the last cells also the last.
    """
    last = len(missing) - 1
    for side in np.unique(size[missing]).tolist():
        here = missing & (size == side)
        rows, columns = np.nonzero(here)
        top = np.minimum(rows // side * side, last - side)
        left = np.minimum(columns // side * side, last - side)
        yield here, rows, columns, top, left, side


def _spread(column: NDArray[Any], computed: Bools, size: Ints) -> NDArray[Any]:
    """Nodes between take what stands at the first corner of their cell: all agree in kind."""
    full = column.copy()
    for here, _, _, top, left, _ in _holding(~computed, size):
        full[here] = column[top, left]
    return full


def _interpolated(value: Floats, computed: Bools, size: Ints) -> Floats:
    full = value.copy()
    for here, rows, columns, top, left, side in _holding(~computed, size):
        down, right = (rows - top) / side, (columns - left) / side
        upper = (1.0 - right) * value[top, left] + right * value[top, left + side]
        lower = (1.0 - right) * value[top + side, left] + right * value[top + side, left + side]
        full[here] = (1.0 - down) * upper + down * lower
    return full
