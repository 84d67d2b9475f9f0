"""State of the checkout and of its environment, for the records of starts and runs."""

import importlib.metadata
import os
import platform
import subprocess
from pathlib import Path
from typing import Any

_PACKAGES = ("vibralign", "numpy", "scipy", "llvmlite", "xarray", "netCDF4", "matplotlib",
             "snakemake")  # fmt: skip


def versions() -> dict[str, str]:
    """Return the versions of Python and of the installed packages that results depend on."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def git_state(folder: Path = Path(__file__).parent) -> dict[str, Any]:
    """Return the commit, and whether the checkout differs from it; empty outside a checkout."""

    def git(*arguments: str) -> str:
        # Without the option, a status writes git's index under a lock. A killed job would leave the
        # lock behind, and git would refuse to work in the checkout.
        # A checkout of another owner, as in a container, is asked too: its code runs here anyway.
        trusted = "--no-optional-locks", "-c", "safe.directory=*", "-C", str(folder)
        own = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
        command = ["git", *trusted, *arguments]
        asked = subprocess.run(command, capture_output=True, text=True, check=True, env=own)
        return asked.stdout.strip()

    changes = "status", "--porcelain", "--", ":(top)", ":(top,exclude)results*"
    try:
        return {"commit": git("rev-parse", "HEAD"), "dirty": bool(git(*changes))}
    except (OSError, subprocess.CalledProcessError):
        return {}
