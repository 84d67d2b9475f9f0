"""The machine of a benchmark: processor, Python and versions."""

import os
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


def facts(packages: Sequence[str]) -> dict[str, object]:
    """Return processor, Python and versions of ``packages``, without the name of the machine."""
    versions = {}
    for name in sorted(set(packages)):
        try:
            versions[name] = version(name)
        except PackageNotFoundError:  # run from its sources, or no Python package
            continue
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "versions": versions,
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    for line in info.read_text(encoding="utf-8").splitlines() if info.is_file() else ():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
