"""Read the chunks of a sweep from the files that its jobs left."""

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from model.study.datasets import DatasetError, discard, read_dataset
from model.study.sweeps import Sweep


def read_chunks(sweep: Sweep, paths: Sequence[Path]) -> list[xr.Dataset]:
    """Read the chunks of a sweep in order; delete a wrong one, so that the next run computes it.

    Raises:
        DatasetError: a file that cannot be read, or that is not the chunk of its name.
    """
    parts, faults = [], {}
    for chunk, path in enumerate(paths):
        expected = {"sweep": sweep.identity, "chunk": chunk, "chunks": len(paths)}
        try:
            part = read_dataset(path)
        except DatasetError as fault:
            faults[path] = str(fault)
        else:
            if any(part.attrs.get(name) != value for name, value in expected.items()):
                faults[path] = f"{path}: is not chunk {chunk} of this sweep"
            parts.append(part)
    discard(faults)
    return parts
