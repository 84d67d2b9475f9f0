"""Alignment times against heyoka, which shares no code: ``python -m verification.bench.truth``.

Sets are drawn by the law of ``make accuracy`` and kept where a run aligns, is not flagged, and
meets nothing but the edge A1 under the bottom face, which is what the peers model. heyoka solves
the peers' own statement of the equations (equations.py) with event location. The independent
solution in ``verification.independent`` covers the whole scene: ``make accuracy``.

An error estimate is now and then too small (decision 3): the rule of ``make accuracy`` judges it
here as well. A set beyond its estimate is run again at a hundredth of the tolerance. Only if the
package then agrees with heyoka was it the estimate; else the two solve different problems, and one
such set is one too many.
"""

import argparse
import csv
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from study.config import load_study, study_path
from verification.accuracy import Check, judge_estimate
from verification.bench.problems import Problem
from verification.bench.trajectories import with_right_edge_only
from verification.trials import trial_of
from vibralign import Parameters, Settings, align

Floats = NDArray[np.float64]

_HEYOKA_TOLERANCES = (1e-15, 1e-12)
_SHARPER = 1e-12  # tolerance at which sets beyond their estimate are run again


class Sets(NamedTuple):
    """Sets that the peers can run: parameters, the package's alignment times and their errors."""

    cases: list[Parameters]
    tau: Floats
    error: Floats


def draw(count: int) -> Sets:
    """Return the first ``count`` random sets that the peers can run."""
    study = load_study(study_path())
    trial = trial_of(study, "error").model_copy(update={"sets": 8 * count})
    settings = trial.settings.settings
    found: list[tuple[Parameters, float, float]] = []
    for first in range(0, 8 * count, 500):
        batch = trial.batch(np.arange(first, min(first + 500, 8 * count)))
        for each in with_right_edge_only(batch, settings):
            found.append(each)
            if len(found) == count:
                cases, times, errors = zip(*found, strict=True)
                return Sets(list(cases), np.array(times), np.array(errors))
    raise ValueError(f"only {len(found)} of {count} sets qualify")


def by_heyoka(sets: Sets) -> tuple[Floats, Floats]:
    """Return heyoka's alignment times, and their errors: the difference from coarser runs."""
    from verification.bench.methods.heyoka_batch import HeyokaBatch  # noqa: PLC0415  (a peer)

    problem = Problem("truth", tuple(sets.cases), Settings(horizon=float(sets.tau.max()) + 1.0))
    engine = HeyokaBatch()
    fine, coarse = (
        engine.solve(problem, sets.cases, tolerance, math.inf).tau_align
        for tolerance in _HEYOKA_TOLERANCES
    )
    return fine, np.abs(fine - coarse) + _HEYOKA_TOLERANCES[1]


class Outside(NamedTuple):
    """A set whose two alignment times differ by more than the sum of their errors."""

    row: int
    factor: float  # difference over the sum of the errors
    explained: bool  # whether the package agrees with heyoka at ``_SHARPER``


def outside(sets: Sets, heyoka: tuple[Floats, Floats]) -> list[Outside]:
    """Return the sets that disagree with heyoka."""
    factors = np.abs(heyoka[0] - sets.tau) / (sets.error + heyoka[1])
    rows = np.flatnonzero(~(factors <= 1.0))
    if not rows.size:
        return []
    few, horizon = [sets.cases[row] for row in rows], float(sets.tau[rows].max()) + 1.0
    runs = align(few, cores=1, horizon=horizon, tolerance=_SHARPER)
    explained = np.abs(heyoka[0][rows] - runs.tau_align) <= runs.tau_error + heyoka[1][rows]
    found = zip(rows.tolist(), factors[rows].tolist(), explained.tolist(), strict=True)
    return [Outside(*each) for each in found]


def judge(sets: Sets, heyoka: tuple[Floats, Floats], beyond: Sequence[Outside]) -> list[Check]:
    """Judge the comparison; ``beyond`` are the sets of ``outside``."""
    apart = np.abs(heyoka[0] - sets.tau)
    unexplained = [each.row for each in beyond if not each.explained]
    return [
        Check("sets", f"{sets.tau.size}"),
        Check("heyoka apart: median", f"{np.nanmedian(apart):.1e}"),
        Check("heyoka apart: largest", f"{np.nanmax(apart):.1e}"),
        *judge_estimate("heyoka", apart, sets.error + heyoka[1]),
        Check("beyond it at a smaller tolerance as well", f"{len(unexplained)}", "0",
                not unexplained),
    ]  # fmt: skip


def explain(sets: Sets, heyoka: tuple[Floats, Floats], beyond: Sequence[Outside]) -> list[str]:
    """Return a line for each set beyond the sum of its error estimates."""
    return [
        f"    set {row}: tau {sets.tau[row]:.12g}, {factor:.1f} times the estimates "
        f"{sets.error[row]:.1e} + {heyoka[1][row]:.1e} from heyoka, "
        + (f"which it agrees with at tolerance {_SHARPER:g}" if explained else "NOT EXPLAINED")
        for row, factor, explained in beyond
    ]


def write(sets: Sets, heyoka: tuple[Floats, Floats], path: Path) -> None:
    """Write all sets into a CSV file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    names = ("tau", "tau_error", "heyoka", "heyoka_error", *sets.cases[0].given())
    columns = (sets.tau, sets.error, *heyoka)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        for case, *values in zip(sets.cases, *(each.tolist() for each in columns), strict=True):
            writer.writerow([*values, *case.given().values()])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the comparison; return the exit code, 1 if a check fails."""
    parser = argparse.ArgumentParser(prog="python -m verification.bench.truth", description=__doc__)
    parser.add_argument("--sets", type=int, default=500)
    given = parser.parse_args(arguments)
    if given.sets < 1:
        parser.error(f"--sets {given.sets}: must be >= 1")
    sets = draw(given.sets)
    heyoka = by_heyoka(sets)
    write(sets, heyoka, Path("results/benchmarks/truth.csv"))
    beyond = outside(sets, heyoka)
    checks = judge(sets, heyoka, beyond)
    lines = [*map(str, checks), *explain(sets, heyoka, beyond)]
    sys.stdout.write("\n".join(lines) + "\n")
    return 1 if any(check.holds is False for check in checks) else 0


if __name__ == "__main__":
    sys.exit(main())
