"""The model: vibratory alignment of a peg with a hole. Each room imports only from those above it.

- ``compile``: kernels, plain Python functions, become machine code or WebAssembly.
- ``physics``: parameters, units, geometry, contacts, forces, equations of motion.
- ``events``: what happens to the contacts, as a table; outcomes of runs; scenes.
- ``engine``: integration from event to event; what a run records.
- ``runs``: settings, runs of one device or many, their errors.
- ``sweeps``: grids of runs as plans, and the datasets that hold their results.
"""

import sys
from typing import Any

_OF_VIBRALIGN = (
    " simulate align Settings Trajectory Alignments Parameters Batch load_device StatedDevice"
    " reliable_at Variants Readings Scene ALIGNMENT INSERTION PRINTED_CONTACTS SUSPENDED"
    " Outcome Reason "
)
_OTHERS = {"read_device": "load_device", "study": "baseline, yield_of, Yield, DeviceResults"}


def _answer(module: str, name: str) -> str:
    """Return what to write for a name of release 1, or an empty text."""
    now = name if f" {name} " in _OF_VIBRALIGN else _OTHERS.get(name)
    return f"{module}.{name}: since release 2 write `from vibralign import {now}`" if now else ""


class _Moved:
    """Finder of last resort, which answers imports of release 1."""

    @staticmethod
    def find_spec(path: str, *_: object) -> None:
        module, _dot, name = path.partition(".")
        if (module == "model" or path == "vibralign.read_device") and (
            words := _answer(module, name)
        ):
            raise ImportError(words)


sys.meta_path.append(_Moved)


def __getattr__(name: str) -> Any:
    raise AttributeError(_answer("model", name) or f"module 'model' has no attribute {name!r}")
