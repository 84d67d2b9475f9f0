"""Compiled kernels, and the bound on numba's version."""

import gc
import os
import shutil
import subprocess
import sys
import threading
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import llvmlite.binding as llvm
import numba
import numpy as np
import pytest
from numba.core.errors import TypingError

from model.compile import jit

PROJECT = Path(__file__).resolve().parents[2]


def halved(x):
    return 0.5 * x


def times(x, count):
    return count * x


def shifted(values, by):
    for i in range(values.size):
        values[i] = values[i] * by + by


part = None  # a kernel, where a test makes it one


def quartered(x):
    return part(part(x))


def six_times(x):
    return part(x, 2) + part(x, 4)


@pytest.fixture
def empty(tmp_path, monkeypatch):
    monkeypatch.setattr(jit, "_CACHE_FOLDER", str(tmp_path))
    return tmp_path


def kept(folder):
    """Return the names of the functions whose machine code is in ``folder``."""
    return {path.name.split("-")[0].split(".")[-1] for path in folder.rglob("*.nbc")}


def test_a_kernel_becomes_machine_code_where_python_calls_it(empty, monkeypatch):
    monkeypatch.setitem(globals(), "part", jit.kernel(halved))
    assert jit.kernel(quartered)(8.0) == 2.0
    assert kept(empty) == {"quartered"}
    assert part(8.0) == 4.0
    assert kept(empty) == {"quartered", "halved"}


@pytest.mark.usefixtures("empty")
def test_a_kernel_called_often_searches_for_no_symbols(monkeypatch):
    made = jit.kernel(halved)
    often = jit.entry_point(made)
    monkeypatch.setattr(jit, "_first_symbol", None)
    assert often(8.0) == 4.0
    assert jit.entry_point(halved) is halved


@pytest.mark.usefixtures("empty")
def test_cached_machine_code_is_loaded_without_compiling(monkeypatch):
    monkeypatch.setitem(globals(), "part", jit.inlined_kernel(halved))
    assert jit.kernel(quartered)(8.0) == 2.0
    monkeypatch.setitem(globals(), "part", None)  # compiling would fail
    assert jit.kernel(quartered)(12.0) == 3.0


SINE = """
import sys
from model.physics.trigonometry import sine_cosine
sine, _ = sine_cosine(0.5)
set_up = "numba.np.linalg" in sys.modules
import numba, numpy
@numba.njit
def norm(values):
    return numpy.linalg.norm(values)
print(sine, set_up, norm(numpy.ones(4)))
"""


def test_another_checkout_with_other_words_loads_from_the_cache_and_sets_up_no_compiler(tmp_path):
    package = shutil.copytree(PROJECT / "src/model", tmp_path / "src/model")
    edited = package / "physics/trigonometry.py"
    words = edited.read_text("utf-8").replace("Sine", "The sine", 1)
    edited.write_text(f"# A comment.\n{words}", "utf-8")
    printed = [
        subprocess.run(
            [sys.executable, "-c", SINE],
            env=os.environ | {"VIBRALIGN_CACHE": str(tmp_path / "kept"), "PYTHONPATH": str(source)},
            capture_output=True, text=True, check=True,
        ).stdout.split()
        for source in (PROJECT / "src", tmp_path / "src")
    ]  # fmt: skip
    sine, sine_again = (float(each[0]) for each in printed)
    assert sine == sine_again == pytest.approx(np.sin(0.5))
    assert [each[1] for each in printed] == ["True", "False"]
    assert [each[2] for each in printed] == ["2.0", "2.0"]  # others compile as they did


def test_threads_calling_a_kernel_at_once_compile_it_once(empty, monkeypatch):
    monkeypatch.setitem(globals(), "part", jit.kernel(halved))
    for _ in range(20):
        made, gate = jit.kernel(quartered), threading.Barrier(4)

        def first(each, made=made, gate=gate):
            gate.wait()
            return made(each), id(made._whole)

        with ThreadPoolExecutor(4) as pool:
            found = list(pool.map(first, [4.0, 8.0, 12.0, 16.0]))
        assert [value for value, _ in found] == [1.0, 2.0, 3.0, 4.0]
        assert len({whole for _, whole in found}) == 1
    assert kept(empty) == {"quartered"}


def wide_registers(dispatcher):
    """Count the registers of 512 bits in the machine code of a dispatcher's only version."""
    (assembler,) = dispatcher.inspect_asm().values()
    return assembler.count("zmm")


def test_kernels_use_the_widest_vectors_and_others_keep_theirs(empty):
    features = llvm.get_host_cpu_features()
    if not features.get("avx512f"):
        pytest.skip("a processor without vectors of 512 bits")
    usual = numba.njit(shifted)
    usual(np.ones(100), 2.0)
    kernel = jit.kernel(shifted)
    kernel(np.ones(100), 2.0)
    assert kept(empty) == {"shifted"}
    assert wide_registers(kernel._whole) > 0
    after = numba.njit(shifted)
    after(np.ones(100), 2.0)
    assert wide_registers(after) == wide_registers(usual)


@pytest.mark.usefixtures("empty")
def test_constant_arguments_compile_no_further_versions(monkeypatch):
    monkeypatch.setitem(globals(), "part", jit.kernel(times))
    assert jit.kernel(six_times)(1.5) == 9.0
    assert len(part.signatures) == 1


@pytest.mark.usefixtures("empty")
@pytest.mark.parametrize("collects", [True, False])
def test_the_garbage_collector_is_restored(monkeypatch, collects):
    monkeypatch.setitem(globals(), "part", jit.kernel(halved))
    before = gc.isenabled()
    (gc.enable if collects else gc.disable)()
    try:
        jit.kernel(quartered)(8.0)
        assert gc.isenabled() is collects
        monkeypatch.setitem(globals(), "part", None)
        with pytest.raises(TypingError):
            jit.kernel(quartered)(8)  # of an integer: compiled anew, and this fails
        assert gc.isenabled() is collects
    finally:
        (gc.enable if before else gc.disable)()


def test_a_numba_beyond_the_bound_is_refused_with_version_bound_and_remedy():
    jit.check_numba(numba.__version__)
    jit.check_numba("0.68.1")
    message = r"numba 0\.69\.0rc1 is installed.*numba < 0\.69.*pip install 'numba<0\.69'"
    for version in ("0.69.0rc1", "0.100.0", "1.0.0"):
        with pytest.raises(ImportError, match=message.replace(r"0\.69\.0rc1", version)):
            jit.check_numba(version)


def test_the_import_is_refused_with_a_numba_beyond_the_bound():
    words = "import numba; numba.__version__ = '0.69.0'; import model"
    run = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert "ImportError: numba 0.69.0 is installed" in run.stderr.splitlines()[-1]


def test_the_bound_on_numba_is_that_of_the_package():
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (declared,) = (each for each in project["dependencies"] if each.startswith("numba"))
    assert declared.endswith(f",<{'.'.join(map(str, jit.NUMBA_BELOW))}")
