"""The package that Python users import."""

import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import vibralign


def in_folder(folder: Path, program: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_it_has_its_names_and_a_version():
    assert vibralign.__version__ == version("vibralign")
    assert set(vibralign.__all__) < set(dir(vibralign))
    assert all(hasattr(vibralign, name) for name in vibralign.__all__)
    with pytest.raises(AttributeError, match="no attribute 'sweeep'"):
        _ = vibralign.sweeep


def test_a_file_of_the_user_may_have_the_name_of_the_package_of_the_study(tmp_path):
    (tmp_path / "model.py").write_text("mine = 1\n", encoding="utf-8")
    found = in_folder(
        tmp_path, "import vibralign as v; print(v.baseline().friction, v.__version__)"
    )
    assert found.stdout.split() == [str(vibralign.baseline().friction), vibralign.__version__]
    late = in_folder(tmp_path, "import model, vibralign")
    assert (
        "model.py: has the name of the package `model`, of which vibralign is made" in late.stderr
    )


def test_it_runs_the_command(tmp_path):
    found = in_folder(tmp_path, "import runpy, sys; sys.argv[1:] = ['--version'];"
                      "runpy.run_module('vibralign', run_name='__main__')")  # fmt: skip
    assert vibralign.__version__ in found.stdout
