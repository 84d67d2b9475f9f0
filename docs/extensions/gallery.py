"""Prepare examples/ for sphinx-gallery: a copy below build/, with notebooks turned into scripts."""

import json
import shutil
from pathlib import Path

from sphinx.application import Sphinx

_REPOSITORY = Path(__file__).parents[2]


def script_of(notebook: Path) -> str:
    """Return a notebook as a script: its title and first text as docstring, later text as comments.

    The first cell is a title and a paragraph; text is plain enough to be Markdown and reST.
    """
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    (kind, first), *others = [(cell["cell_type"], "".join(cell["source"])) for cell in cells]
    title, _, text = first.removeprefix("# ").partition("\n")
    parts = [f'"""\n{title}\n{"=" * len(title)}\n{text}\n"""']
    for kind, source in others:
        mark = "" if kind == "code" else "# "
        parts += ["# %%", *(f"{mark}{line}" for line in source.splitlines())]
    return "\n".join(parts) + "\n"


def setup(_: Sphinx) -> dict[str, bool]:
    """Copy the examples, before sphinx-gallery runs; the results beside them are the reference."""
    folder = _REPOSITORY / "build" / "examples"
    for old in (folder, folder.parent / "results"):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(_REPOSITORY / "examples", folder)
    for notebook in folder.glob("*.ipynb"):
        notebook.with_suffix(".py").write_text(script_of(notebook), encoding="utf-8")
        notebook.unlink()
    shutil.copytree(_REPOSITORY / "tests" / "reference", folder.parent / "results" / "data")
    return {"parallel_read_safe": True, "parallel_write_safe": True}
