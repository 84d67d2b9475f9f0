"""Cost of a round part over that of a square one: ``python -m benchmarks.shapes``.

Random devices, drawn by the law of ``make accuracy``, start where the press tilts a round part and
are run one by one as either shape, on the same base. CPU time of one core, code warm, the shortest
of several rounds in which the shapes take turns.
"""

import argparse
import sys
from collections.abc import Sequence
from time import process_time
from typing import NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from model.engine.results import RunResult
from model.physics.parameters import Shape
from model.runs.engines import Engine, engine_for
from study.config import load_study, study_path
from verification.trials import trial_of
from vibralign import Batch, Outcome, Settings

Floats = NDArray[np.float64]
ENGINES: tuple[Engine, ...] = get_args(Engine)
_SHARES = 0.2, 0.9  # misalignment over the largest from which the press tilts a round part
_TOLERANCE = 1e-8


class Cost(NamedTuple):
    """Cost of every device as one shape: seconds, steps, and whether it aligns; shapes (n,)."""

    seconds: Floats
    steps: Floats
    aligns: NDArray[np.bool_]


def devices(count: int) -> Batch:
    """Return random devices whose press tilts a round part towards the hole."""
    drawn = trial_of(load_study(study_path()), "error").batch(np.arange(count)).values
    wider = 1.0 + drawn["clearance"]
    farthest = drawn["half_width"] * np.sqrt(wider * wider - 1.0)
    shares = np.random.default_rng(55).uniform(*_SHARES, count)
    return Batch({**drawn, "misalignment": shares * farthest})


def costs(batch: Batch, engine: Engine, horizon: float, rounds: int) -> dict[Shape, Cost]:
    """Run every device as either shape, and return what each costs."""
    shapes: tuple[Shape, ...] = get_args(Shape)
    runs = {}
    for shape in shapes:
        settings = Settings(shape=shape, tolerance=_TOLERANCE, horizon=horizon, may_settle=False)
        runs[shape] = engine_for(settings, engine), settings.rows(batch)
    seconds = {shape: np.full(len(batch), np.inf) for shape in shapes}
    found = {shape: np.empty((len(batch), len(RunResult._fields))) for shape in shapes}
    tolerances = np.array([_TOLERANCE])
    for number in range(len(batch)):
        for turn in range(rounds + 1):  # the first one warms the code up
            for shape, (run, rows) in runs.items():
                start = process_time()
                found[shape][number] = run(rows[number : number + 1], tolerances)[0]
                if turn:
                    taken = process_time() - start
                    seconds[shape][number] = min(seconds[shape][number], taken)
    ended = {shape: RunResult(*rows.T) for shape, rows in found.items()}
    return {
        shape: Cost(seconds[shape], each.steps, each.outcome == Outcome.ALIGNED)
        for shape, each in ended.items()
    }


def line(engine: str, which: str, round_ones: Cost, square: Cost, of: NDArray[np.bool_]) -> str:
    """Return a row of the table, of the devices in the mask ``of``."""
    time, steps = (
        getattr(round_ones, n)[of] / getattr(square, n)[of] for n in ("seconds", "steps")
    )
    total = round_ones.seconds[of].sum() / square.seconds[of].sum()
    low, middle, high = np.quantile(time, (0.1, 0.5, 0.9))
    return (
        f"{engine:7} {which:12} {of.sum():4d} {middle:7.2f} {low:5.2f} to {high:5.2f} "
        f"{total:6.2f} {np.median(steps):6.2f} {np.median(time / steps):8.2f}"
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.shapes", description=__doc__)
    parser.add_argument("--devices", type=int, default=200)
    parser.add_argument("--horizon", type=float, default=100.0)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args(arguments)
    batch = devices(given.devices)
    sys.stdout.write("engine  devices       n  median  10 to 90 %  total  steps  per step\n")
    for engine in ENGINES:
        found = costs(batch, engine, given.horizon, given.rounds)
        round_ones, square = found["round"], found["square"]
        both = round_ones.aligns & square.aligns
        neither = ~round_ones.aligns & ~square.aligns
        for which, of in (("all", both | True), ("both align", both), ("neither", neither)):
            if of.any():
                sys.stdout.write(line(engine, which, round_ones, square, of) + "\n")
                sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
