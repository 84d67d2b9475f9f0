"""Yields of two devices against brute force: ``make yields``.

A million devices, drawn independently, give the yield to 0.05 %. The interval of `assess` is then
computed 40 times with other Sobol' points; at least 95 % of the intervals must hold that yield.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from model import Settings, load_device
from model.study.assessment.judge import run_devices
from model.study.assessment.yields import from_unit_cube, yield_of

DEVICES = Path(__file__).resolve().parents[1] / "docs" / "devices"
# Values and tolerances at which some devices fail.
CASES = {
    "peg": {"tilt_stiffness": "0.5 N m/rad ± 10 %", "friction": "0.2 ± 0.08"},
    "pin": {"misalignment": "0.2 mm ± 0.1 mm", "friction": "0.3 ± 0.1"},
}
STARTS = [{"phase": phase, "initial_tilt": 0.001} for phase in (0.0, np.pi)]
SETTINGS = Settings(tolerance=1e-6, horizon=150.0)
REPETITIONS, POINTS, CHUNK = 40, 1024, 2**14


def brute_force(name: str, count: int, cores: int) -> float:
    """Return the share of ``count`` independent devices that go in from every start."""
    stated = load_device(DEVICES / f"{name}.yaml", CASES[name])
    rng = np.random.default_rng(2026)
    going_in = done = 0
    while done < count:
        size = min(CHUNK, count - done)
        values = from_unit_cube(stated, rng.random((size, len(stated.tolerances))))
        going_in += int(run_devices(stated, values, STARTS, SETTINGS, cores).goes_in.sum())
        done += size
    return going_in / count


def intervals(name: str, cores: int) -> np.ndarray:
    """Return the intervals of the repetitions, shape (repetitions, 2)."""
    stated = load_device(DEVICES / f"{name}.yaml", CASES[name])
    found = [
        yield_of(stated, STARTS, SETTINGS, cores, devices=POINTS, seed=seed, indices=False)[0]
        for seed in range(1, 1 + REPETITIONS)
    ]
    return np.array([(each.low, each.high) for each in found])


def main() -> int:
    """Compare both devices; exit with 1 if too few intervals hold the yield."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--devices", type=int, default=1_000_000, help="of the brute force")
    parser.add_argument("--cores", type=int, default=2)
    arguments = parser.parse_args()
    failed = False
    for name in CASES:
        truth = brute_force(name, arguments.devices, arguments.cores)
        bounds = intervals(name, arguments.cores)
        inside = int(((bounds[:, 0] <= truth) & (truth <= bounds[:, 1])).sum())
        failed |= inside < 0.95 * REPETITIONS
        width = float(np.diff(bounds).mean())
        words = f"in {inside} of {REPETITIONS} intervals, {100 * width:.2f} % wide on average"
        print(f"{name}: {100 * truth:.2f} % of {arguments.devices} devices; {words}", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
