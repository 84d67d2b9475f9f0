"""The version of this package."""

import importlib.metadata


def version() -> str:
    """Return the version of this package."""
    try:
        return importlib.metadata.version("vibralign")
    except importlib.metadata.PackageNotFoundError:
        return "(not installed)"
