"""A made-up bench: a device of two unknowns, and trials that the model makes at a truth."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from model.events.insertion import INSERTION
from model.runs.settings import Settings
from vibralign import StatedDevice
from vibralign.known.possible import run_sets, touch_downs

QUICK = Settings(scene=INSERTION, tolerance=1e-6)
FILE = Path(__file__).parents[3] / "examples" / "bench.yaml"
TRUTH = {"friction": 0.15, "tilt_stiffness": 0.3}
SETTINGS = [
    {"press_force": f"{force} N", "amplitude": f"{amplitude} mm"}
    for force, amplitude in (
        (10, 2), (4, 1.2), (12, 3), (8, 2.5), (5, 2), (7, 1.5), (14, 2.5), (3, 1.2), (9, 1.8),
        (6, 2.2), (11, 2.8), (5, 1.4),
    )
]  # fmt: skip
ERROR, WAITED = 0.03, 2.0


def trials_of(
    device: StatedDevice,
    truth: Mapping[str, float],
    settings: Sequence[Mapping[str, str]],
    rng: np.random.Generator,
) -> list[dict[str, str]]:
    """Return trials at a truth, each from a touch-down of its own."""
    rows = []
    sets = {name: np.array([value]) for name, value in truth.items()}
    for setting in settings:
        own = replace(device.changed(**setting), horizon=WAITED)
        downs = touch_downs(own, 64, seed=int(rng.integers(2**30)))
        one = int(rng.integers(64))
        some = {name: column[one : one + 1] for name, column in downs.items()}
        time = float(run_sets(own, sets, some, QUICK).time[0, 0])
        time *= float(np.exp(ERROR * rng.standard_normal()))
        words = f"{1e3 * time:.6g} ± {1e3 * ERROR * time:.6g} ms"
        rows.append({**setting, "result": words if time <= WAITED else "fails after 2 s"})
    return rows


def truth_of(device: StatedDevice, rng: np.random.Generator) -> dict[str, float]:
    """Return a truth from the ranges."""
    return {name: float(each.at(rng.random())) for name, each in device.unknown.items()}
