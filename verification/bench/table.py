"""The table of ``make bench``: times at equal true error, printed and written.

Methods climb the same ladder of tolerances from coarse to fine. The first tolerance that keeps the
target error is the method's setting; its row is the cost of a trajectory there.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from model.sweeps.files import write_text
from study.csv_tables import records_text
from verification.bench.methods.base import Method, NotReachedError, typical_error
from verification.bench.problems import Problem
from verification.bench.work_precision import climbed, cpu_microseconds
from vibralign.commands.tables import or_null, table

TARGET = 1e-8  # true error that nine of ten cases must keep
TOLERANCES = [float(f"{10.0 ** (half / 2.0):.3g}") for half in range(-8, -29, -1)]
_SLOW = 4.0  # seconds; a call longer than this is timed once


@dataclass(frozen=True)
class Row:
    """A row of the table; where numbers are NaN, ``remark`` says why.

    ``ratio`` is the method's time over that of the first method. ``microseconds``, ``evaluations``
    and ``events`` are means of a trajectory.
    """

    problem: str
    method: str
    tolerance: float = math.nan
    true_error: float = math.nan
    microseconds: float = math.nan
    evaluations: float = math.nan
    ratio: float = math.nan
    events: float = math.nan
    remark: str = ""


def compare(problem: Problem, methods: Sequence[Method], budget: float, rounds: int) -> list[Row]:
    """Return the cost of methods at the loosest tolerance that keeps ``TARGET``, fastest first.

    Args:
        problem: the problem to solve.
        methods: all methods; ratios refer to the first.
        budget: CPU seconds for the ladder of a method, without compilation.
        rounds: number of times that all methods are timed in turn; the median counts.
    """
    rows: list[Row] = []
    clocks: list[Callable[[], float]] = []
    for method in methods:
        row = loosest(method, problem, budget)
        clock: Callable[[], float] = partial(float, "nan")
        if not row.remark:
            try:
                row, clock = _first_call(method, problem, row)
            except NotReachedError as reason:  # neighbours of the cases can be harder
                row = replace(row, remark=str(reason))
        rows.append(row)
        clocks.append(clock)
    times = np.median([[clock() for clock in clocks] for _ in range(rounds)], axis=0)
    rows = [
        replace(row, microseconds=time, ratio=time / times[0])
        for row, time in zip(rows, times.tolist(), strict=True)
    ]
    return sorted(rows, key=lambda row: (math.isnan(row.microseconds), row.microseconds))


def loosest(method: Method, problem: Problem, budget: float) -> Row:
    """Return the row of the first tolerance that keeps ``TARGET``, without its time."""

    def warmed() -> Iterator[float]:
        for tolerance in TOLERANCES:
            method.warm(problem, tolerance)
            yield tolerance

    row = Row(problem.name, method.name, events=problem.events)
    try:
        for tolerance, solution in climbed(method, problem, warmed(), budget):
            error = typical_error(problem.answers(solution), problem.truth)
            if error <= TARGET:
                return replace(row, tolerance=tolerance, true_error=error)
    except NotReachedError as reason:
        return replace(row, remark=str(reason))
    return replace(row, remark="not at any tolerance")


def _first_call(method: Method, problem: Problem, row: Row) -> tuple[Row, Callable[[], float]]:
    """Return the row with its evaluations, and a function that times a trajectory in µs."""
    sets = problem.batch(method.batch) if method.batch > 1 else problem.cases
    solve = partial(method.solve, problem, sets, row.tolerance, math.inf)
    started = process_time()
    evaluations = solve().evaluations
    seconds = process_time() - started

    def clock() -> float:
        once = 1e6 * seconds
        if seconds <= _SLOW:
            once = cpu_microseconds(lambda count: [solve() for _ in range(count)])
        return once / len(sets)

    counted = math.nan if evaluations is None else evaluations / len(sets)
    return replace(row, evaluations=counted), clock


def text(rows: Sequence[Row]) -> str:
    """Return the rows of a problem as a table for the terminal."""
    head = f"{rows[0].problem}, true error {TARGET:g}, {rows[0].events:,.1f} events"
    names = ("method", "microseconds", "ratio", "evaluations", "tolerance", "true_error", "remark")
    return "\n".join([head, *table([or_null(vars(row)) for row in rows], names)])


def write(rows: Sequence[Row], folder: Path) -> None:
    """Write ``peers.csv`` into ``folder``."""
    formats = {each.name: ".6g" for each in fields(Row) if each.type is float}
    write_text(records_text(Row, rows, formats), folder / "peers.csv")
