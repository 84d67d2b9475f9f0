"""Generated sources, as debuggers and tracebacks show them."""

import inspect
import linecache
import os
import re
import subprocess
import sys
import traceback
from pathlib import Path

import pytest

from model.compile import source
from model.compile.jit import kernel, python_of
from model.events.kernels import ALIGNMENT_EVENTS

CODE = "def inverse(x):\n    return one / x\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(source, "_SOURCES", tmp_path / "sources")
    return tmp_path / "sources"


def test_a_traceback_through_a_generated_function_shows_its_lines(folder):
    inverse = source.defined("inverse", CODE, {"one": 1.0}, "numbers")
    assert inverse(4.0) == 0.25
    with pytest.raises(ZeroDivisionError) as caught:
        inverse(0.0)
    shown = "".join(traceback.format_exception(caught.value))
    assert "in inverse\n    return one / x" in shown
    (file,) = folder.iterdir()
    assert file.name.startswith("numbers.inverse-")
    assert f'File "{file}", line 2' in shown


@pytest.mark.usefixtures("folder")
def test_a_debugger_finds_the_source_of_a_generated_function():
    made = kernel(source.defined("inverse", CODE, {"one": 1.0}))
    linecache.checkcache()
    assert inspect.getsource(python_of(made)) == CODE
    assert Path(inspect.getsourcefile(python_of(made))).read_text() == CODE
    assert source.is_generated(made)
    assert not source.is_generated(kernel)


def test_a_debugger_finds_the_source_of_the_kernels_of_events():
    shown = inspect.getsource(python_of(ALIGNMENT_EVENTS.reset))
    assert shown.startswith("def reset(which, q, p, mode):\n    if which == ")


RUN = """
from model.study.config import baseline
from model.runs.settings import Settings
from model.runs.simulate import simulate_once
simulate_once(baseline(), Settings(horizon=1e-3))
"""
# The first sample is that of the track's first row, the second is taken by the event location.
COMMANDS = """
from model.events.kernels import ALIGNMENT_EVENTS
b ALIGNMENT_EVENTS.sample_into
c
c
step
next
where
q
"""


def test_a_debugger_steps_through_event_location_in_a_run_without_compiling(tmp_path):
    script = tmp_path / "run.py"
    script.write_text(RUN)
    settings = {"NUMBA_DISABLE_JIT": "1", "VIBRALIGN_CACHE": str(tmp_path)}
    debugged = subprocess.run(
        [sys.executable, "-m", "pdb", script], input=COMMANDS.strip(), env=os.environ | settings,
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    _, located, shown = debugged.partition("scalar/location.py")
    assert located, debugged
    assert re.search(r"sources/alignment\.sample_into-\w+\.py\(2\)\S+\n-> found = sample\(", shown)
    assert re.search(r"sources/alignment\.sample-\w+\.py\(2\)sample\(\)\n-> f0 = NEVER", shown)


def test_the_same_source_is_kept_once_and_as_it_was(folder):
    source.defined("inverse", CODE, {"one": 1.0})
    (file,) = folder.iterdir()
    before = file.stat()
    source.defined("inverse", CODE, {"one": 2.0})
    source.defined("inverse", CODE.replace("/", "-"), {"one": 2.0})
    assert len(list(folder.iterdir())) == 2
    assert file.stat() == before


def test_where_no_file_can_be_written_the_lines_are_shown_nevertheless(folder):
    folder.write_text("not a folder")
    inverse = source.defined("inverse", CODE, {"one": 1.0})
    assert inspect.getsource(inverse) == CODE
