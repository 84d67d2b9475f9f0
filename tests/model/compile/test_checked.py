"""Code that is checked tells of an index beyond its array; the package's own has none."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.model.compile.sources import PRELUDE

KERNELS = """\
@inlined_kernel
def item(w, n):
    return w[n]


@separate_kernel
def put(w, n):
    w[n] = 5.0


@kernel
def reads(w, n):
    return item(w, n)


@kernel
def writes(w, n):
    put(w, n)


@kernel
def in_lanes(w, n):
    for i in each_lane():
        w[n * WIDTH + i] += 1.0


@kernel
def of_rows(a, n):
    a[n, 1] = 2.0
    row = a[n - 1]
    row[0] = 1.0


@kernel
def of_a_part(w, n):
    w[2:][n] = 3.0


@kernel
def of_a_tuple(w, n):
    return (1.0, 2.0, 3.0)[n]


@kernel
def of_a_table(w, n):
    return TABLE[n]


@kernel
def counts(k, n):
    return fetch_add(k[n:], 1)


TABLE = np.arange(4.0)
"""

PROGRAM = """\
import runpy, sys

import numpy as np

from model.compile.entries import compiled
from model.compile.vector_code import WIDTH

found = runpy.run_path(sys.argv[1])
LENGTHS = {"of_a_tuple": 3, "of_a_table": 4, "in_lanes": 4, "of_a_part": 2}
LENGTHS |= dict.fromkeys(("reads", "writes", "of_rows", "counts"), 4)
for name, length in LENGTHS.items():
    for n in (-1, 0, 1, length - 1, length, 9, -(2**40), 2**40):
        whole = np.zeros(400)
        w = whole[100 : 100 + 4 * (WIDTH if name == "in_lanes" else 1)]
        if name == "of_rows":
            w = whole[100:112].reshape(4, 3)
        if name == "counts":
            w = whole.view(np.int64)[100:104]
        try:
            compiled(found[name])(w, n)
            told = ""
        except IndexError as error:
            told = str(error)
        outside = np.abs(whole[:100]).sum() + np.abs(whole[100 + w.size :]).sum()
        beyond = not (1 if name == "of_rows" else 0) <= n < length
        if name == "counts":
            beyond = n >= length  # a slice counts from the end
        if bool(told) != beyond or (told and f"in kernel '" not in told) or outside != 0.0:
            print(name, n, told, outside)
"""


def in_process(*arguments: str, checked: str = "1") -> str:
    """Return what a process prints whose kernels are ``checked``."""
    run = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "VIBRALIGN_CHECKED": checked},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_every_index_beyond_its_array_is_told_and_nothing_there_is_written(tmp_path: Path) -> None:
    (tmp_path / "kernels.py").write_text(PRELUDE + KERNELS)
    assert not in_process("-c", PROGRAM, str(tmp_path / "kernels.py"))


def test_the_place_of_an_index_is_told(tmp_path: Path) -> None:
    (tmp_path / "kernels.py").write_text(f"{PRELUDE}@kernel\ndef last(w, n):\n    return w[n]\n")
    program = (
        "import runpy, sys, numpy as np\n"
        "from model.compile.entries import compiled\n"
        "last = compiled(runpy.run_path(sys.argv[1])['last'])\n"
        "try:\n    last(np.ones(4), 4)\nexcept IndexError as error:\n    print(error)\n"
        "print(last(np.ones(4), 3))"
    )
    told, value = in_process("-c", program, str(tmp_path / "kernels.py")).splitlines()
    line = PRELUDE.count("\n") + 3
    expected = f"kernels.py:{line}: in kernel 'last': the index 4 of 4 items"
    assert told.endswith(expected)
    assert value == "1.0"


FUZZ = """\
from dataclasses import replace

from model.runs.align import align
from verification.fuzz import SCENES, draw

for settings, laws in SCENES.values():
    for shape in ("square", "round"):
        print(len(align(draw(7, 0, {sets}, laws), replace(settings, shape=shape))))
"""


@pytest.mark.nightly
def test_no_index_of_the_package_lies_beyond_its_array() -> None:
    sets = int(os.environ.get("VIBRALIGN_SETS", "60"))
    assert in_process("-c", FUZZ.format(sets=sets)).split() == [str(sets)] * 4
