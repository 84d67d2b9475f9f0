"""The ratio table, as it is printed and as it is kept."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from benchmarks.equal_error import Cost, Setting
from model.study.csv_tables import records_text


@dataclass(frozen=True)
class Row:
    """A line of the table; NaN where there is no number, and then a remark says why.

    ``ratio`` is the method's time over that of the package's first engine at the same target.
    ``events`` are those of a trajectory, in the mean; each has its share of the time.
    """

    problem: str
    target_error: float
    method: str
    formulation: str
    tolerance: float
    true_error: float
    microseconds: float
    evaluations: float
    ratio: float
    nanoseconds_per_evaluation: float
    events: float
    nanoseconds_per_event: float
    remark: str


def rows(
    costs: Sequence[Cost], missed: Sequence[Setting], order: Sequence[tuple[str, float]]
) -> list[Row]:
    """A row for each cost, fastest first in every problem and target, then the settings missed.

    Problems and targets are in the order of ``order``. The reference of the ratios is the first
    of ``costs`` with the same problem and target.
    """
    reference: dict[tuple[str, float], float] = {}
    for cost in costs:
        reference.setdefault(_group(cost.setting), cost.microseconds)
    made = [
        _row(cost.setting, cost.microseconds, cost.evaluations, reference[_group(cost.setting)])
        for cost in costs
    ]
    made += [_row(setting, math.nan, math.nan, math.nan) for setting in missed]
    return sorted(made, key=lambda row: (order.index((row.problem, row.target_error)), _late(row)))


def _group(setting: Setting) -> tuple[str, float]:
    return setting.problem.name, setting.target


def _late(row: Row) -> float:
    return math.inf if math.isnan(row.microseconds) else row.microseconds


def _row(setting: Setting, microseconds: float, evaluations: float, reference: float) -> Row:
    return Row(
        problem=setting.problem.name,
        target_error=setting.target,
        method=setting.method.name,
        formulation=setting.method.formulation,
        tolerance=setting.tolerance,
        true_error=setting.error,
        microseconds=microseconds,
        evaluations=evaluations,
        ratio=microseconds / reference,
        nanoseconds_per_evaluation=1e3 * microseconds / evaluations,
        events=setting.problem.events,
        nanoseconds_per_event=1e3 * microseconds / setting.problem.events,
        remark=setting.reason,
    )


def text(table: Sequence[Row]) -> str:
    """The table to read: a block for each problem and target."""
    width = max((len(row.method) for row in table), default=0)
    lines: list[str] = []
    last = None
    for row in table:
        group = (row.problem, row.target_error)
        if group != last:
            lines += [
                "",
                f"{row.problem}, true error {row.target_error:g}, {row.events:,.1f} events",
            ]
            lines.append(
                f"  {'method':{width}}  {'µs/traj.':>12}  {'ratio':>8}  {'evaluations':>11}"
                f"  {'ns/eval.':>8}  {'ns/event':>9}  {'tolerance':>9}  {'error':>7}"
            )
            last = group
        lines.append(f"  {row.method:{width}}  " + _numbers(row))
    return "\n".join(lines[1:])


def _numbers(row: Row) -> str:
    if math.isnan(row.microseconds):
        return f"{'–':>12}  not reached: {row.remark}"
    return (
        f"{row.microseconds:12,.1f}  {row.ratio:8,.2f}  {_or_dash(row.evaluations, '11,.0f')}"
        f"  {_or_dash(row.nanoseconds_per_evaluation, '8,.1f')}"
        f"  {row.nanoseconds_per_event:9,.0f}"
        f"  {row.tolerance:9.1e}  {row.true_error:7.0e}"
    )


def _or_dash(value: float, spec: str) -> str:
    width = int(spec.partition(",")[0])
    return f"{'–':>{width}}" if math.isnan(value) else format(value, spec)


def write(table: Sequence[Row], machine: Mapping[str, object], folder: Path) -> None:
    """``peers.csv`` and ``machine.json`` in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    formats = {each.name: ".6g" for each in fields(Row) if each.type is float}
    (folder / "peers.csv").write_text(records_text(Row, table, formats), encoding="utf-8")
    machine_file = folder / "machine.json"
    machine_file.write_text(json.dumps(machine, indent=2, sort_keys=True) + "\n", encoding="utf-8")
