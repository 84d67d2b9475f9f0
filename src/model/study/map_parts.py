"""What has been computed of a map: on its lattice, in one of its parts, and on disk.

A map is computed in parts, by jobs of their own, and assembled from what they know. Which nodes are
computed depends on the map only (runs.refinement), so the parts may be cut as one likes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.runs.refinement import Bools, Ints, Lattice
from model.study.datasets import DatasetError, discard, read_dataset

_TILES = 8  # along a side; a part is made of several
_AT_ONCE = 2048  # nodes, so that progress can be told

Columns = Mapping[str, NDArray[Any]]
Compute = Callable[[Ints, Ints], Columns]
"""(rows, columns) of nodes to what is known of them then, each of shape (m,)."""


@dataclass
class Known:
    """What has been computed of a map so far: columns over all nodes, and where they are known."""

    computed: Bools
    columns: dict[str, NDArray[Any]]

    @classmethod
    def nothing(cls, lattice: Lattice, unknown: Columns) -> "Known":
        """No node of ``lattice``; ``unknown`` stands for what is not known, with its type."""
        columns = {name: np.full(lattice.shape, value) for name, value in unknown.items()}
        return cls(np.zeros(lattice.shape, dtype=np.bool_), columns)

    def enter(self, rows: Ints, columns: Ints, values: Columns) -> None:
        """Add nodes."""
        for name, column in self.columns.items():
            column[rows, columns] = values[name]
        self.computed[rows, columns] = True

    @property
    def nodes(self) -> tuple[Ints, Ints]:
        """Rows and columns of what is known."""
        rows, columns = np.nonzero(self.computed)
        return rows, columns

    def of(self, rows: Ints, columns: Ints) -> Columns:
        """What is known of nodes, each column of shape (m,)."""
        return {name: column[rows, columns] for name, column in self.columns.items()}


def remembered(
    known: Known, compute: Compute, progress: Callable[[int], None] = lambda _: None
) -> Compute:
    """``compute`` where nothing is known yet, a bounded number of nodes at a time."""

    def look_up(rows: Ints, columns: Ints) -> Columns:
        new = np.flatnonzero(~known.computed[rows, columns])
        for first in range(0, new.size, _AT_ONCE):
            some = new[first : first + _AT_ONCE]
            progress(int(new.size - first))
            known.enter(rows[some], columns[some], compute(rows[some], columns[some]))
        return known.of(rows, columns)

    return look_up


def tiles(lattice: Lattice, part: int, parts: int) -> Bools:
    """The coarse cells of one of ``parts``: squares of them, dealt out so that parts cost alike.

    Raises:
        ValueError: a part that is not one of ``parts``.
    """
    if not 0 <= part < parts:
        raise ValueError(f"part = {part}: must be 0 to {parts - 1}")
    count = lattice.cells // lattice.coarse
    tile = np.arange(count) // max(count // _TILES, 1)
    return (3 * tile[:, None] + tile) % parts == part


# --- On disk ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Part:
    """Which part of which map: its name, the identity of its plan, part ``part`` of ``parts``."""

    figure: str
    sweep: str
    part: int
    parts: int


def part_dataset(part: Part, known: Mapping[str, Known]) -> xr.Dataset:
    """What one part knows: columns over its nodes, for each name in ``known``."""
    variables: dict[str, Any] = {}
    for prefix, each in known.items():
        rows, columns = each.nodes
        variables[f"{prefix}_row"] = (prefix, rows.astype(np.int32))
        variables[f"{prefix}_column"] = (prefix, columns.astype(np.int32))
        for name, values in each.of(rows, columns).items():
            variables[f"{prefix}_{name}"] = (prefix, values)
    return xr.Dataset(variables, attrs=asdict(part))


def read_part(path: Path, part: Part, known: Mapping[str, Known]) -> None:
    """Enter what a part on disk knows into ``known``.

    Raises:
        DatasetError: a file that cannot be read, or that is not this part of this map.
    """
    stored = read_dataset(path)
    if any(stored.attrs.get(name) != value for name, value in asdict(part).items()):
        raise DatasetError(f"{path}: is not part {part.part} of this map")
    for prefix, each in known.items():
        rows, columns = (stored[f"{prefix}_{name}"].values for name in ("row", "column"))
        values = {name: stored[f"{prefix}_{name}"].values for name in each.columns}
        each.enter(rows, columns, values)


def read_parts(paths: Sequence[Path], figure: str, sweep: str, known: Mapping[str, Known]) -> None:
    """Enter all parts of a map; what is not one is deleted, so that the next run makes it.

    Raises:
        DatasetError: as ``read_part``, naming every such file.
    """
    faults = {}
    for part, path in enumerate(paths):
        try:
            read_part(path, Part(figure, sweep, part, len(paths)), known)
        except DatasetError as fault:
            faults[path] = str(fault)
    discard(faults)
