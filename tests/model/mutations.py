"""Tests on a copy of the package with one edit: a mutation must make one of them fail."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]
Edit = tuple[str, str, str]
"""File, what stands there once, and what is put in its place."""


def replaced(path: Path, old: str, new: str) -> str:
    """Return the text of a file with ``new`` in place of ``old``."""
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1, f"{old!r} must stand once in {path.name}: adapt the mutation"
    return text.replace(old, new)


def run_on_copy(
    folder: Path, room: str, edit: Edit | None, tests: Sequence[str]
) -> subprocess.CompletedProcess[str]:
    """Run tests until one fails, on a copy of the package with an edit below ``src/model/room``."""
    for copied in ("src", "config"):  # the study's files lie beside its sources
        shutil.copytree(PROJECT / copied, folder / copied)
    if edit is not None:
        file, old, new = edit
        path = folder / "src/model" / room / file
        path.write_text(replaced(path, old, new), encoding="utf-8")
    paths = f"pythonpath={folder / 'src'} ."  # before those of pyproject.toml
    options = ["-x", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-o", paths]
    return subprocess.run(
        [sys.executable, "-m", "pytest", *options, *tests],
        cwd=PROJECT,
        env={
            **os.environ,
            "PYTHONPATH": str(folder / "src"),
            "VIBRALIGN_CACHE": str(folder / "kernels"),
        },
        capture_output=True,
        text=True,
        check=False,
    )


def assert_caught(run: subprocess.CompletedProcess[str]) -> None:
    """Fail unless a test has failed; wrong machine code may end the process by a signal."""
    is_caught = run.returncode == pytest.ExitCode.TESTS_FAILED or run.returncode < 0
    assert is_caught, run.stdout + run.stderr
    has_error = re.search(r"^ERROR ", run.stdout, re.MULTILINE)  # in pytest's summary
    assert not has_error, run.stdout
