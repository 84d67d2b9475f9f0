"""The machine of a benchmark: processor, Python and versions."""

import importlib.metadata
import os
import platform
from collections.abc import Sequence
from pathlib import Path


def facts(packages: Sequence[str]) -> dict[str, object]:
    """Return processor, Python and versions of ``packages``, without the name of the machine."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "versions": {
            name: version for name in sorted(set(packages)) if (version := _version(name))
        },
    }


def processor() -> str:
    """Return the name of the processor, from the operating system."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None  # run from its sources, or no Python package
