"""The model: vibratory alignment of a peg with a hole. Each room imports only from those above it.

- ``compile``: kernels, plain Python functions, become machine code or WebAssembly.
- ``physics``: parameters, units, geometry, contacts, forces, equations of motion.
- ``events``: what happens to the contacts, as a table; outcomes of runs; scenes.
- ``engine``: integration from event to event; what a run records.
- ``runs``: settings, runs of one device or many, their errors.
- ``sweeps``: grids of runs as plans, and the datasets that hold their results.
"""

from typing import Any

_OF_VIBRALIGN = (
    " simulate align Settings Trajectory Alignments Parameters Batch load_device read_device"
    " StatedDevice reliable_at Variants Readings Scene ALIGNMENT INSERTION PRINTED_CONTACTS"
    " SUSPENDED Outcome Reason "
)


def __getattr__(name: str) -> Any:
    if f" {name} " in _OF_VIBRALIGN:
        now = "load_device" if name == "read_device" else name
        raise ImportError(f"model.{name}: since release 2 write `from vibralign import {now}`")
    raise AttributeError(f"module 'model' has no attribute {name!r}")
