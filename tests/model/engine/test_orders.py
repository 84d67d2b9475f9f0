"""Series of a lower order give the same outcomes, and times within the estimates.

The package's order is a constant of its code: the other one runs in a copy with an edit.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from model.engine.tolerances import MARGIN
from model.events.outcomes import Reason
from tests.model.mutations import PROJECT, replaced

SETS = int(os.environ.get("VIBRALIGN_SETS", "60"))
FIELDS = (
    "outcome", "reason", "sensitive", "tau_align", "tau_error", "tau_inserted", "insertion_error",
)  # fmt: skip
PROGRAM = """\
import sys
from dataclasses import replace

import numpy as np

from model.engine.series_layout import ORDER
from model.runs.align import align
from verification.fuzz import SCENES, draw

_, scene, shape, sets, fields, into = sys.argv
settings, laws = SCENES[scene]
# Steps of a lower order are shorter, and more: few sets may end at the limit of evaluations.
settings = replace(settings, shape=shape, max_evaluations=4 * settings.max_evaluations)
found = align(draw(13, 0, int(sets), laws), settings)
np.savez(into, order=ORDER, **{name: getattr(found, name) for name in fields.split()})
"""
# Reasons that a few evaluations more or less decide.
LIMITS = Reason.TOO_MANY_EVALUATIONS, Reason.CHAOTIC


def found(sources: Path, into: Path, scene: str, shape: str, sets: int) -> dict[str, np.ndarray]:
    """Results of random sets, from a copy of the package."""
    asked = scene, shape, str(sets), " ".join(FIELDS), str(into)
    variables = {**os.environ, "PYTHONPATH": str(sources)}
    subprocess.run([sys.executable, "-c", PROGRAM, *asked], cwd=PROJECT, env=variables, check=True)
    with np.load(into) as stored:
        return dict(stored)


@pytest.mark.parametrize(
    ("scene", "shape", "sets"),
    [
        ("alignment", "square", 60),
        *(
            pytest.param(scene, shape, SETS, marks=pytest.mark.nightly)
            for scene in ("alignment", "insertion")
            for shape in ("square", "round")
        ),
    ],
)
def test_two_orders_agree(tmp_path: Path, scene: str, shape: str, sets: int) -> None:
    edited = Path(shutil.copytree(PROJECT / "src", tmp_path / "src"))
    layout = edited / "model/engine/series_layout.py"
    layout.write_text(replaced(layout, "ORDER = 16  #", "ORDER = 12  #"), encoding="utf-8")
    one, other = (
        found(sources, tmp_path / f"{n}.npz", scene, shape, sets)
        for n, sources in enumerate((PROJECT / "src", edited))
    )
    assert (one["order"], other["order"]) == (16, 12)
    certain = ~(one["sensitive"] | other["sensitive"])
    certain &= ~(np.isin(one["reason"], LIMITS) | np.isin(other["reason"], LIMITS))
    assert certain.sum() > 0.4 * sets
    for name in ("outcome", "reason"):
        np.testing.assert_array_equal(one[name][certain], other[name][certain])
    for time, error in (("tau_align", "tau_error"), ("tau_inserted", "insertion_error")):
        apart = np.abs(one[time] - other[time])[certain]
        estimate = (one[error] + other[error])[certain]
        timed = np.isfinite(apart)
        np.testing.assert_array_equal(timed, np.isfinite(one[time][certain]))
        assert timed.any() or time == "tau_inserted"  # of the insertion scene only
        assert (apart <= MARGIN * estimate)[timed].all()
        assert (apart > estimate)[timed].sum() <= 0.05 * timed.sum()
