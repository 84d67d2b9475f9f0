"""Compile the engines for the explorer, into the cache, and state what was made."""

import hashlib
from pathlib import Path

from model.runs.in_browser import modules
from model.tracking.provenance import write_json


def run(stated: Path) -> None:
    """Write the interface of the modules with their sizes and hashes."""
    made = modules()
    binaries = {"run_one": made.run_one, "run_many": made.run_many}
    facts = {
        name: {"bytes": len(each), "sha256": hashlib.sha256(each).hexdigest()}
        for name, each in binaries.items()
    }
    write_json({**made.interface, "modules": facts}, stated)
