"""Compute a map in parts: refine its layers, remember the nodes, and keep parts on disk.

A map has one or more layers, each refined on a lattice of its own (refinement.py). Parts are
computed by separate jobs and assembled from the nodes that they know. Which nodes are computed
depends on the map only, so it may be cut into any number of parts.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.study.datasets import DatasetError, discard, read_dataset
from model.study.refinement import Bools, Floats, Ints, Lattice, Refined, refine

_TILES = 8  # along a side; a part is made of several
_AT_ONCE = 2048  # nodes between two reports of progress

Columns = Mapping[str, NDArray[Any]]
"""Quantities of nodes by name, each of shape (m,)."""

Progress = Callable[[str, int, int], None]
"""(name of the layer, starts computed so far, nodes of this wave still to come)."""


@dataclass
class Known:
    """The nodes computed so far: columns over the whole lattice, and where they are known.

    A column may have a further axis.
    """

    computed: Bools
    columns: dict[str, NDArray[Any]]

    @classmethod
    def nothing(cls, lattice: Lattice, unknown: Columns) -> "Known":
        """No node of ``lattice``; ``unknown`` gives each column's type and its placeholder."""
        columns = {
            name: np.full(lattice.shape + value.shape, value) for name, value in unknown.items()
        }
        return cls(np.zeros(lattice.shape, dtype=np.bool_), columns)

    def enter(self, rows: Ints, columns: Ints, values: Columns) -> None:
        """Add nodes."""
        for name, column in self.columns.items():
            column[rows, columns] = values[name]
        self.computed[rows, columns] = True

    def keep(self, computed: Bools, unknown: Columns) -> None:
        """Forget the nodes that are not ``computed``."""
        for name, column in self.columns.items():
            column[~computed] = unknown[name]
        self.computed &= computed

    def of(self, rows: Ints, columns: Ints) -> Columns:
        """Return the columns of nodes."""
        return {name: column[rows, columns] for name, column in self.columns.items()}


Complete = Callable[[Mapping[str, Refined], Known, Callable[[int], None]], None]


@dataclass(frozen=True)
class Layer:
    """A quantity over a map, refined on its own lattice.

    Attributes:
        name: prefix of its variables in a part's dataset.
        lattice: nodes and rule of refinement.
        unknown: as for ``Known.nothing``.
        compute: (rows, columns, known so far) -> columns of these nodes.
        compare: (rows, columns, their columns) -> kinds and values, which refine the lattice.
        complete: (refined maps of this layer and those before it, known, progress) -> None;
            computes what depends on other layers, and tells the nodes of each wave.
        starts: known -> number of runs.
    """

    name: str
    lattice: Lattice
    unknown: Columns
    compute: Callable[[Ints, Ints, Known], Columns]
    compare: Callable[[Ints, Ints, Columns], tuple[Ints, Floats]]
    complete: Complete = lambda *_: None
    starts: Callable[[Known], int] = lambda known: int(known.computed.sum())


class RefinedPlan(Protocol):
    """A map as data, and its layers."""

    @property
    def name(self) -> str:
        """Name of the map."""

    @property
    def identity(self) -> str:
        """Hash of all that its numbers depend on besides the code."""

    def layers(self, cores: int = 1) -> Sequence[Layer]:
        """Return the layers, computed on ``cores``."""


AllKnown = dict[str, Known]
"""The known nodes of each layer, by its name."""


def nothing_known(plan: RefinedPlan) -> AllKnown:
    """Return a map without computed nodes."""
    return {each.name: Known.nothing(each.lattice, each.unknown) for each in plan.layers()}


def compute_part(plan: RefinedPlan, part: int = 0, parts: int = 1, *, cores: int = 1) -> AllKnown:
    """Refine the cells of one part of a map, as far as its own nodes decide.

    Raises:
        ValueError: a part that is not one of ``parts``.
    """
    known = nothing_known(plan)
    refine_map(plan, known, cores=cores, within=lambda lattice: _tiles(lattice, part, parts))
    return known


def refine_map(
    plan: RefinedPlan,
    known: AllKnown,
    *,
    cores: int = 1,
    progress: Progress = lambda *_: None,
    within: Callable[[Lattice], Bools | None] = lambda _: None,
) -> dict[str, Refined]:
    """Refine every layer; nodes missing in ``known`` are computed and entered.

    From the parts of a map, nodes are missing where cells of two parts touch. Nodes that the
    refined map does not need are forgotten.
    """
    layers = plan.layers(cores)

    def tell(layer: Layer, left: int) -> None:
        progress(layer.name, sum(each.starts(known[each.name]) for each in layers), left)

    found: dict[str, Refined] = {}
    for layer in layers:
        nodes = known[layer.name]
        found[layer.name] = _refine_layer(layer, nodes, within(layer.lattice), tell)
        layer.complete(found, nodes, partial(tell, layer))
    return found


def _refine_layer(
    layer: Layer, nodes: Known, within: Bools | None, tell: Callable[[Layer, int], None]
) -> Refined:
    """Refine one layer as ``refine_map``; ``tell`` is called with the nodes still to come."""

    def evaluate(rows: Ints, columns: Ints) -> tuple[Ints, Floats]:
        new = np.flatnonzero(~nodes.computed[rows, columns])
        for first in range(0, new.size, _AT_ONCE):
            some = new[first : first + _AT_ONCE]
            tell(layer, int(new.size - first))
            found = layer.compute(rows[some], columns[some], nodes)
            nodes.enter(rows[some], columns[some], found)
        return layer.compare(rows, columns, nodes.of(rows, columns))

    found = refine(evaluate, layer.lattice, within)
    nodes.keep(found.computed, layer.unknown)
    return found


def _tiles(lattice: Lattice, part: int, parts: int) -> Bools:
    """The coarse cells of one of ``parts``: square tiles, dealt out so that parts cost alike."""
    if not 0 <= part < parts:
        raise ValueError(f"part = {part}: must be 0 to {parts - 1}")
    count = lattice.cells // lattice.coarse
    tile = np.arange(count) // max(count // _TILES, 1)
    return (3 * tile[:, None] + tile) % parts == part


# --- On disk ------------------------------------------------------------------------------------


def _stamp(plan: RefinedPlan, part: int, parts: int) -> dict[str, Any]:
    return {"figure": plan.name, "sweep": plan.identity, "part": part, "parts": parts}


def part_dataset(plan: RefinedPlan, part: int, parts: int, known: AllKnown) -> xr.Dataset:
    """Return the nodes that one part knows: the columns of each layer over its nodes."""
    variables: dict[str, Any] = {}
    for name, each in known.items():
        rows, columns = np.nonzero(each.computed)
        values = {"row": rows.astype(np.int32), "column": columns.astype(np.int32)}
        values |= each.of(rows, columns)
        variables |= {
            f"{name}_{column}": ((name, f"{name}_start")[: value.ndim], value)
            for column, value in values.items()
        }
    return xr.Dataset(variables, attrs=_stamp(plan, part, parts))


def read_parts(plan: RefinedPlan, paths: Sequence[Path]) -> AllKnown:
    """Read all parts of a map; a file that is not its part is deleted, so that it is made again.

    Raises:
        DatasetError: files that cannot be read or are not parts of this map, naming each.
    """
    known, faults = nothing_known(plan), {}
    for part, path in enumerate(paths):
        try:
            stored = read_dataset(path)
            if not _stamp(plan, part, len(paths)).items() <= stored.attrs.items():
                raise DatasetError(f"{path}: is not part {part} of this map")  # noqa: TRY301
        except DatasetError as fault:
            faults[path] = str(fault)
            continue
        for name, each in known.items():
            rows, columns = (stored[f"{name}_{side}"].values for side in ("row", "column"))
            each.enter(rows, columns, {of: stored[f"{name}_{of}"].values for of in each.columns})
    discard(faults)
    return known
