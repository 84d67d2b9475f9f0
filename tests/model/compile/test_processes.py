"""Processes and their cache: two at once, one that is killed, another processor, edited code."""

import os
import platform
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from model.compile import machine_code
from model.compile.identity import PACKAGE
from tests.model.compile.sources import PRELUDE

KERNELS = """\
@separate_kernel
def shared(x):
    return 0.1 * x + 1.0


@kernel
def first(x):
    return shared(x) * x


@kernel
def second(x):
    s = 0.0
    for i in range(100):
        s += shared(x + i) / (i + 0.7)
    return s
"""

# Runs kernels, some of the package too, and prints their results and how many were compiled.
PROGRAM = """\
import os, runpy, signal, sys
from pathlib import Path
from typing import Any

from model.compile import machine_code
from model.compile.entries import compiled
from model.physics.geometry import bottom_corner
from model.physics.contacts import dot

compile_, count = machine_code.object_of, 0
write = Path.write_bytes

def counted(*arguments):
    global count
    count += 1
    if sys.argv[2:] == ["dies while it compiles"] and count == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return compile_(*arguments)

def half(path, content):
    write(path, content[: len(content) // 2])
    os.kill(os.getpid(), signal.SIGKILL)

machine_code.object_of = counted
if sys.argv[2:] == ["dies while it writes"]:
    Path.write_bytes = half
if sys.argv[2:] == ["waits"]:
    print("ready", flush=True)
    sys.stdin.readline()
found = runpy.run_path(sys.argv[1])
calls = [(name, x) for name in ("first", "second") for x in (0.3, 2.0)]
results = [compiled(found[name], contract=False)(x) for name, x in calls]
results.append(compiled(dot, contract=False)((1.1, 2.3, 3.7), 0.1, 0.2, 0.3))
print(count, *(each.hex() for each in results))
"""
PYTHON = sys.executable
ALL = 4  # objects: the part, two entries of the file, one of the package


class Runs:
    """Runs the program, by a package of its own if one is given."""

    def __init__(self, folder: Path) -> None:
        self.kernels, self.folder, self.package = folder / "kernels.py", folder / "cache", PACKAGE
        self.kernels.write_text(PRELUDE + KERNELS)

    def start(self, *how: str, **variables: str) -> "subprocess.Popen[str]":
        paths = {"PYTHONPATH": str(self.package.parent), "VIBRALIGN_CACHE": str(self.folder)}
        return subprocess.Popen(
            [sys.executable, "-c", PROGRAM, str(self.kernels), *how],
            env={**os.environ, **paths, **variables},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def run(self, *how: str, **variables: str) -> tuple[int, list[str]]:
        """Return how many objects were compiled, and the results."""
        process = self.start(*how, **variables)
        told, _ = process.communicate()
        assert process.returncode == 0
        count, *results = told.split()
        return int(count), results


@pytest.fixture
def runs(tmp_path: Path) -> Runs:
    return Runs(tmp_path)


def test_two_processes_on_one_empty_cache(runs: Runs) -> None:
    processes = [runs.start("waits") for _ in range(2)]
    for each in processes:
        assert each.stdout is not None
        assert each.stdout.readline() == "ready\n"
    told = [each.communicate("\n")[0] for each in processes]
    assert all(each.returncode == 0 for each in processes)
    count, results = runs.run()
    assert count == 0
    assert [each.split()[1:] for each in told] == [results, results]


@pytest.mark.parametrize("how", ["dies while it compiles", "dies while it writes"])
def test_a_process_that_is_killed_leaves_nothing_that_is_loaded(runs: Runs, how: str) -> None:
    process = runs.start(how)
    process.communicate()
    assert process.returncode == -9
    count, results = runs.run()
    assert count >= 2, "what was not written whole"
    runs.folder = runs.folder.with_name("another")
    assert runs.run() == (ALL, results)


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="names one of its kind")
def test_another_processor_has_machine_code_of_its_own(runs: Runs) -> None:
    assert runs.run()[0] == ALL
    count, results = runs.run(VIBRALIGN_CPU="x86-64")
    assert count == ALL
    assert runs.run() == (0, results), "to the bit, without fused operations"
    assert runs.run(VIBRALIGN_CPU="x86-64") == (0, results)


def test_words_of_the_package_may_be_edited_and_its_code_is_compiled_anew(
    runs: Runs, tmp_path: Path
) -> None:
    without = shutil.ignore_patterns("__pycache__", "show", "cli")
    shutil.copytree(PACKAGE, tmp_path / "copy" / "model", ignore=without)
    runs.package = tmp_path / "copy" / "model"
    count, results = runs.run()
    assert count == ALL
    edited = runs.package / "physics" / "contacts.py"
    text = edited.read_text(encoding="utf-8")
    edited.write_text(f"# why\n\n{text.replace('Return', 'Give')}", encoding="utf-8")
    assert runs.run() == (0, results)
    changed = "return row[0] * x + row[1] * y + row[2] * moment"
    assert changed in text
    edited.write_text(text.replace(changed, "return row[0] * x"), encoding="utf-8")
    count, others = runs.run()
    assert count == 1, "the kernel that was edited"
    assert others[:-1] == results[:-1]
    assert others[-1] == (1.1 * 0.1).hex()


@pytest.mark.parametrize("python", [PYTHON, "/bin/false", "no such program"])
def test_objects_are_the_same_by_another_process_and_without_one(
    python: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "define double @f{}(double %x) {{\n%y = fadd double %x, {}.0\nret double %y\n}}"
    modules = [(text.format(n, n), False) for n in range(6)]
    monkeypatch.setattr(machine_code, "_SHORT", 0)
    monkeypatch.setattr(sys, "executable", python)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    here: list[str] = []
    compile_ = machine_code.object_of
    alone = [compile_(*each) for each in modules]

    def slow(*module: Any) -> bytes:
        time.sleep(0.3)  # the other process has started and takes some
        here.append(module[0])
        return compile_(*module)

    monkeypatch.setattr(machine_code, "object_of", slow)
    assert machine_code.objects_of(modules) == alone
    assert (len(here) < len(modules)) == (python == PYTHON)
