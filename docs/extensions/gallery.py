"""Prepare examples/ for sphinx-gallery: a copy below build/, beside the accepted results."""

import shutil
from pathlib import Path

from sphinx.application import Sphinx

_REPOSITORY = Path(__file__).parents[2]


def setup(_: Sphinx) -> dict[str, bool]:
    """Copy the examples, before sphinx-gallery runs; the results beside them are the reference."""
    folder = _REPOSITORY / "build" / "examples"
    for old in (folder, folder.parent / "results"):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(_REPOSITORY / "examples", folder)
    shutil.copytree(_REPOSITORY / "tests" / "reference", folder.parent / "results" / "data")
    return {"parallel_read_safe": True, "parallel_write_safe": True}
