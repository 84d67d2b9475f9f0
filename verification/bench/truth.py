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
import math
import sys
from collections.abc import Sequence
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


def judge(sets: Sets, heyoka: tuple[Floats, Floats]) -> list[Check]:
    """Judge the comparison with heyoka's times and their errors; sets beyond both are run again."""
    apart, allowed = np.abs(heyoka[0] - sets.tau), sets.error + heyoka[1]
    rows = np.flatnonzero(~(apart <= allowed))
    unexplained = _unexplained(sets, heyoka, rows) if rows.size else rows
    found = ", ".join(f"set {row}: {apart[row] / allowed[row]:.1f} times" for row in unexplained)
    return [
        Check("sets", f"{sets.tau.size}"),
        Check("heyoka apart: median", f"{np.nanmedian(apart):.1e}"),
        Check("heyoka apart: largest", f"{np.nanmax(apart):.1e}"),
        *judge_estimate("heyoka", apart, allowed),
        Check("beyond it at a smaller tolerance as well", found or "0", "0", not found),
    ]


def _unexplained(
    sets: Sets, heyoka: tuple[Floats, Floats], rows: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the rows whose times differ from heyoka's at ``_SHARPER`` as well."""
    few, horizon = [sets.cases[row] for row in rows], float(sets.tau[rows].max()) + 1.0
    runs = align(few, cores=1, horizon=horizon, tolerance=_SHARPER)
    return rows[~(np.abs(heyoka[0][rows] - runs.tau_align) <= runs.tau_error + heyoka[1][rows])]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the comparison; return the exit code, 1 if a check fails."""
    parser = argparse.ArgumentParser(prog="python -m verification.bench.truth", description=__doc__)
    parser.add_argument("--sets", type=int, default=500)
    given = parser.parse_args(arguments)
    if given.sets < 1:
        parser.error(f"--sets {given.sets}: must be >= 1")
    sets = draw(given.sets)
    checks = judge(sets, by_heyoka(sets))
    sys.stdout.write("\n".join([*map(str, checks), ""]))
    return 1 if any(check.holds is False for check in checks) else 0


if __name__ == "__main__":
    sys.exit(main())
