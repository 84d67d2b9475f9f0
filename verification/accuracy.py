"""Accuracy of the integrator on random sets: `make accuracy`.

Two trials draw parameter sets from the distributions in the configuration:

- "error" compares alignment times and their ``tau_error`` with runs at a tolerance of 1e-13 and
  with the independent solution, and the reasons for leaving the scene with the latter;
- "settled" continues runs that ended as settled to several times the horizon.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from model.events.outcomes import Outcome, Reason
from model.physics.parameters import Batch, Constants
from model.runs.align import align, run_once
from model.runs.engine import engine_for
from model.runs.errors import estimate
from model.runs.settings import Settings
from model.sweeps.axes import points_of_chunk
from model.sweeps.files import atomic_write
from verification.bench.problems import last_state
from verification.independent import solve
from verification.trials import Trial

Table = dict[str, NDArray[Any]]

TIGHT = 1e-13  # tolerance of the run taken as the truth
ACCURATE = 1e-8  # accuracy wanted of a regular alignment time
_AFTER = 1.0  # time after the run's end within which the independent solution may end
# Endings of the independent solution for every reason to leave the scene.
LEAVING = {
    Reason.MOVED_AWAY: ("face far", "right wall"),  # "right wall" too where it comes down beside
    Reason.OVERSHOT: ("face far", "left wall"),
    Reason.CORNER_ON_WALL: ("right wall", "left wall"),
    Reason.EDGE_ON_OTHER_FACE: ("other face",),
    Reason.BOTH_SIDES: ("both sides",),
    Reason.OVERTURNED: ("overturned",),
}
_UNBOUNDED = 2_000_000_000  # evaluations: only the horizon stops a run
# Requirements on error estimates (decision 3): share of errors below the estimate, share below ten
# times the estimate, and largest median of estimate over error.
_COVERED, _NEARLY_COVERED, _TOO_LARGE = 0.95, 0.999, 30.0
# Largest further motion of a settled run: a difference of 1e-3 that shrinks by 0.98 a period.
FARTHEST = 0.05


def run_trial(trial: Trial, chunk: int, chunks: int) -> Table:
    """Run one chunk of a trial; return a table with one row a set."""
    numbers = points_of_chunk(trial.sets, chunk, chunks)
    run = _errors if trial.name == "error" else _settled
    return {"set": numbers, **run(trial.batch(numbers), trial.settings.settings, trial.longer)}


def _errors(batch: Batch, settings: Settings, _longer: float) -> Table:
    """Return default runs, runs at ``TIGHT``, and independent solutions.

    The latter are of the runs that align or leave the scene and are not sensitive.
    """
    runs = align(batch, settings, cores=1)
    left = runs.outcome == Outcome.LEFT_SCENE
    ended = np.where(left, run_once(batch, settings, cores=1)["time"], runs.tau_align)
    tight = align(batch, settings, cores=1, tolerance=TIGHT, max_evaluations=_UNBOUNDED)
    independent, independent_end = np.full((2, len(batch)), math.nan)
    ending = ["not run"] * len(batch)
    for row in np.flatnonzero(np.isfinite(ended) & ~runs.sensitive):
        try:
            solution = solve(batch[int(row)], float(ended[row]) + _AFTER)
        except ArithmeticError:
            ending[row] = "failed"
        else:
            independent[row], independent_end[row] = solution.tau, solution.time
            ending[row] = solution.ending
    return {
        "outcome": runs.outcome,
        "reason": runs.reason,
        "end": ended,
        "tau_align": runs.tau_align,
        "tau_error": runs.tau_error,
        "sensitive": runs.sensitive.astype(np.int8),
        "tight_outcome": tight.outcome,
        "tight_tau": tight.tau_align,
        "independent_tau": independent,
        "independent_end": independent_end,
        "independent_ending": np.array(ending),
    }


def _moved(
    row: NDArray[np.float64], tolerance: float, ended: float, settings: Settings, longer: float
) -> tuple[int, float]:
    """Return (outcome, farthest motion) of a run that ``ended`` settled, to ``longer`` horizons.

    The state is compared after one cycle, and as many as fit into a 64th, an eighth and all of the
    time to that horizon, by runs that end there. They carry their errors if the run that settled
    did: so their motions are the same to the bit.
    """
    for carries in (True, False):
        end, state = last_state(settings, row, tolerance, carries_error=carries)
        if end.outcome == Outcome.SETTLED and end.time == ended:
            break
    else:
        return int(end.outcome), math.nan
    on_and_on = replace(settings, may_settle=False, max_evaluations=_UNBOUNDED)
    cycle = end.period * 2.0 * math.pi / Constants(*row).frequency
    whole = int((longer * settings.horizon - end.time) / cycle)
    moved, outcome = 0.0, -1
    for cycles in (1, whole // 64, whole // 8, whole):
        later = replace(on_and_on, horizon=end.time + cycles * cycle)
        there, its_state = last_state(later, row, tolerance, carries_error=carries)
        moved, outcome = max(moved, float(np.abs(its_state - state).max())), int(there.outcome)
    return outcome, moved


def _settled(batch: Batch, settings: Settings, longer: float) -> Table:
    """Return default runs, and for settled ones the motion up to ``longer`` times the horizon."""
    rows = settings.rows(batch)
    run, carrying = engine_for(settings), engine_for(settings, carries_error=True)
    found = estimate(run, carrying, rows, settings.tolerance, settings.horizon)
    results = found.columns()
    outcome, ended = results["outcome"], results["time"]
    later, moved = np.full(len(rows), -1, dtype=np.int8), np.full(len(rows), math.nan)
    for i in np.flatnonzero(outcome == Outcome.SETTLED):
        tolerance = float(found.tolerance[i])
        later[i], moved[i] = _moved(rows[i], tolerance, float(ended[i]), settings, longer)
    return {"outcome": outcome, "later_outcome": later, "later_moved": moved}


# ----------------------------------------------------------------------------------------- check


class Check(NamedTuple):
    """One line of the summary: a quantity, its value, and the required value.

    ``holds`` is None if nothing is required.
    """

    what: str
    found: str
    wanted: str = ""
    holds: bool | None = None

    def __str__(self) -> str:
        mark = {None: "", True: "holds", False: "FAILS"}[self.holds]
        return f"{self.what:58} {self.found:26} {self.wanted:11} {mark}".rstrip()


def _share(name: str, counted: NDArray[np.bool_], least: float) -> Check:
    share = float(np.mean(counted)) if counted.size else math.nan
    found = f"{100 * share:.2f} % ({int(counted.sum())} of {counted.size})"
    return Check(name, found, f">= {100 * least:g} %", share >= least)


def judge_estimate(
    truth: str, error: NDArray[np.float64], estimate: NDArray[np.float64]
) -> list[Check]:
    """Return checks of error estimates; ``error`` and ``estimate`` have shape (n,).

    Errors are measured against ``truth``, whose name goes into the checks. An error of NaN, for a
    set that ends otherwise, is covered by no estimate.
    """
    ratio = np.divide(estimate, error, out=np.full(error.size, math.inf), where=error > 0.0)
    median = float(np.median(ratio[np.isfinite(error)]))
    return [
        _share(f"error below tau_error, {truth}", error <= estimate, _COVERED),
        _share(f"error below 10 tau_error, {truth}", error <= 10.0 * estimate, _NEARLY_COVERED),
        Check(f"median of tau_error over error, {truth}", f"{median:.1f}", f"<= {_TOO_LARGE:g}",
                median <= _TOO_LARGE),
    ]  # fmt: skip


def judge_errors(table: Table) -> list[Check]:
    """Judge the "error" trial."""
    flagged = table["sensitive"] == 1
    aligned = table["outcome"] == Outcome.ALIGNED
    regular = {name: values[aligned & ~flagged] for name, values in table.items()}
    share = float(np.mean(flagged))
    chaotic = table["reason"] == Reason.CHAOTIC
    otherwise = aligned != (table["tight_outcome"] == Outcome.ALIGNED)
    unsaid = otherwise & ~flagged & ~chaotic
    estimate = regular["tau_error"]
    truths = ("tight_tau", "independent_tau")
    error = {truth: np.abs(regular["tau_align"] - regular[truth]) for truth in truths}
    apart = np.abs(regular["tight_tau"] - regular["independent_tau"])
    unfinished = np.isin(table["independent_ending"], ["failed", "endless"])
    return [
        Check("sets", f"{flagged.size}"),
        Check("sets that align", f"{int(aligned.sum())}"),
        Check("sets flagged sensitive", f"{100 * share:.2f} %", "<= 2 %", share <= 0.02),
        Check("of those, sets that align", f"{int((flagged & aligned).sum())}"),
        Check("sets that are chaotic", f"{int(chaotic.sum())}"),
        Check("of those, sets that align at the tight tolerance",
                f"{int((chaotic & otherwise).sum())}"),
        Check("sets of neither that align at one tolerance only", f"{int(unsaid.sum())}", "0",
                not unsaid.any()),
        *judge_estimate(f"tolerance {TIGHT:g}", error["tight_tau"], estimate),
        *judge_estimate("independent solution", error["independent_tau"], estimate),
        Check("independent solutions unfinished", f"{int(unfinished.sum())}", "0",
                not unfinished.any()),
        Check("the two truths apart: median", f"{np.nanmedian(apart):.1e}"),
        Check("the two truths apart: 99th percentile", f"{np.nanquantile(apart, 0.99):.1e}"),
        _share("the two truths apart by less than tau_error", apart <= estimate, 0.999),
        Check("median of tau_error", f"{np.median(estimate):.1e}"),
        Check("99th percentile of tau_error", f"{np.quantile(estimate, 0.99):.1e}"),
        Check(f"tau_error <= {ACCURATE:g}", f"{100 * np.mean(estimate <= ACCURATE):.2f} %"),
        *_judge_leaving({name: values[~flagged] for name, values in table.items()}),
    ]  # fmt: skip


def _judge_leaving(table: Table) -> list[Check]:
    """Return checks of the sets that leave the scene; ``table`` has no flagged sets."""
    left = np.flatnonzero(table["outcome"] == Outcome.LEFT_SCENE)
    if not left.size:
        return []
    endings, reasons = table["independent_ending"][left], table["reason"][left]
    alike = [
        ending in LEAVING.get(Reason(int(reason)), ())
        for ending, reason in zip(endings, reasons, strict=True)
    ]
    apart = np.abs(table["end"] - table["independent_end"])[left]
    return [
        _share("leave the scene as in the independent solution", np.array(alike), 0.999),
        Check("their ends apart: median", f"{np.nanmedian(apart):.1e}"),
    ]


def is_wrong(table: Table) -> NDArray[np.bool_]:
    """Return a mask of sets that settled, and later aligned, left, failed or moved all the same."""
    settled = table["outcome"] == Outcome.SETTLED
    near = np.nan_to_num(table["later_moved"], nan=math.inf) <= FARTHEST
    return settled & ~((table["later_outcome"] == Outcome.HORIZON_REACHED) & near)


def judge_settled(table: Table) -> list[Check]:
    """Judge the "settled" trial; the numbers of wrong sets are listed."""
    settled, wrong = table["outcome"] == Outcome.SETTLED, is_wrong(table)
    numbers = ", ".join(str(number) for number in table["set"][wrong])
    moved = table["later_moved"][settled]
    return [
        Check("sets", f"{settled.size}"),
        Check("sets that settle", f"{int(settled.sum())}"),
        Check("wrongly settled", f"{int(wrong.sum())}" + (f": sets {numbers}" if numbers else ""),
                "0", not wrong.any()),
        Check("farthest motion afterwards", f"{np.fmax.reduce(moved, initial=0.0):.1e}",
                f"<= {FARTHEST:g}"),
    ]  # fmt: skip


def summary(errors: Table, settled: Table) -> str:
    """Return both trials as text, one line for each check."""
    lines = []
    for title, checks in (
        ("tau_error on random sets", judge_errors(errors)),
        ("settled runs, run on", judge_settled(settled)),
    ):
        lines += [title, "-" * len(title), *map(str, checks), ""]
    return "\n".join(lines)


# ------------------------------------------------------------------------------------------ tables


def write_table(table: Mapping[str, NDArray[Any]], path: Path) -> None:
    """Write a table as CSV, numbers with all their digits."""
    with atomic_write(path) as part:
        pd.DataFrame(table).to_csv(part, index=False, na_rep="nan", lineterminator="\n")


def read_tables(paths: Sequence[Path]) -> Table:
    """Return the table of all chunks in ``paths``, sorted by the number of the set.

    The start of the study has compared each file with what its job left.

    Raises:
        ValueError: a set is missing or occurs twice.
    """
    table = pd.concat([pd.read_csv(path) for path in paths]).sort_values("set")
    if not np.array_equal(table["set"], np.arange(len(table))):
        raise ValueError("the chunks do not hold each set once: delete them and run again")
    return {str(name): values.to_numpy() for name, values in table.items()}
