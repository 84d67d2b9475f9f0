"""The width of vectors changes no result, and is refused if it is none."""

import os
import subprocess
import sys

import numpy as np
import pytest

from model.compile.vector_code import WIDTH, WIDTHS
from model.runs.engine import engine_for
from verification.fuzz import SCENES, draw

SETS = int(os.environ.get("VIBRALIGN_SETS", "60"))
PROGRAM = """\
import hashlib
from dataclasses import replace

import numpy as np

from model.compile.vector_code import WIDTH
from model.runs.align import run_once
from verification.fuzz import SCENES, draw

print(WIDTH)
for scene in {scenes}:
    settings, laws = SCENES[scene]
    for shape in {shapes}:
        found = run_once(draw(11, 0, {sets}, laws), replace(settings, shape=shape))
        print(hashlib.sha256(np.nan_to_num(np.array([*found.values()])).tobytes()).hexdigest())
"""


def told(program: str, width: str, processor: str = "") -> subprocess.CompletedProcess[str]:
    variables = {"VIBRALIGN_WIDTH": width, "VIBRALIGN_CPU": processor}
    return subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, **variables},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.parametrize("scene", SCENES)
def test_a_row_of_a_batch_equals_the_same_run_alone_with_its_error(scene: str) -> None:
    settings, laws = SCENES[scene]
    rows = settings.rows(draw(23, 0, 4 * WIDTH + 1, laws))
    tolerances = np.geomspace(1e-7, 1e-11, len(rows))
    run = engine_for(settings, carries_error=True)
    together = run(rows, tolerances)
    for n in range(len(rows)):
        (alone,) = run(rows[n : n + 1], tolerances[n : n + 1])
        np.testing.assert_array_equal(alone, together[n])


@pytest.mark.parametrize(
    ("widths", "sets", "scenes", "shapes"),
    [
        ((1, 2), 20, ("alignment",), ("square",)),
        pytest.param(WIDTHS, SETS, tuple(SCENES), ("square", "round"), marks=pytest.mark.nightly),
    ],
    ids=["few sets", "every width"],
)
def test_results_are_the_same_to_the_bit_at_two_widths(
    widths: tuple[int, ...], sets: int, scenes: tuple[str, ...], shapes: tuple[str, ...]
) -> None:
    program = PROGRAM.format(sets=sets, scenes=scenes, shapes=shapes)
    runs = [told(program, str(width)) for width in widths]
    assert all(each.returncode == 0 for each in runs), [each.stderr for each in runs]
    found, *results = zip(*(each.stdout.split() for each in runs), strict=True)
    assert [*map(int, found)] == [*widths]
    assert [len({*each}) for each in results] == [1] * (len(scenes) * len(shapes))
