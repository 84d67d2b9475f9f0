import csv
import json
import math
from pathlib import Path

from benchmarks.equal_error import Cost, Setting
from benchmarks.methods.base import Method
from benchmarks.problems import Problem
from benchmarks.table import rows, text, write
from benchmarks.trajectories import W1
from model import Settings, simulate


def setting(method: str, problem: str, target: float = 1e-8, reason: str = "") -> Setting:
    made = Method()
    made.name, made.formulation, made.package = method, "as it is", "none"
    number = math.nan if reason else 1e-9
    return Setting(
        made, Problem(problem, (W1,), Settings(horizon=1.0)), target, number, number, reason
    )


COSTS = [
    Cost(setting("ours", "W2"), 50.0, 1000.0),
    Cost(setting("theirs", "W2"), 200.0, math.nan),
    Cost(setting("ours", "W1"), 4.0, 40.0),
    Cost(setting("theirs", "W1"), 1.0, 20.0),
]
MISSED = [setting("late", "W1", reason="out of time")]
ORDER = [("W1", 1e-8), ("W2", 1e-8)]


def test_ratios_are_to_the_first_method_of_the_same_problem_and_target() -> None:
    table = rows(COSTS, MISSED, ORDER)
    assert [(row.problem, row.method) for row in table] == [
        ("W1", "theirs"),
        ("W1", "ours"),
        ("W1", "late"),
        ("W2", "ours"),
        ("W2", "theirs"),
    ]
    assert [row.ratio for row in table if row.method != "late"] == [0.25, 1.0, 1.0, 4.0]
    assert table[0].nanoseconds_per_evaluation == 50.0
    assert table[0].nanoseconds_per_event == 1e3 / table[0].events
    assert table[0].events == simulate(W1, horizon=1.0).events > 0


def test_the_text_says_why_a_method_has_no_number() -> None:
    lines = text(rows(COSTS, MISSED, ORDER)).splitlines()
    assert lines[0] == f"W1, true error 1e-08, {COSTS[2].setting.problem.events:.1f} events"
    (late,) = [line for line in lines if "late" in line]
    assert late.endswith("not reached: out of time")
    assert sum("theirs" in line for line in lines) == 2


def test_what_is_kept_can_be_read_again(tmp_path: Path) -> None:
    write(rows(COSTS, MISSED, ORDER), {"peak_gflops": 58.7}, tmp_path)
    with (tmp_path / "peers.csv").open(encoding="utf-8", newline="") as handle:
        kept = list(csv.DictReader(handle))
    assert [row["ratio"] for row in kept] == ["0.25", "1", "nan", "1", "4"]
    assert kept[2]["remark"] == "out of time"
    assert json.loads((tmp_path / "machine.json").read_text()) == {"peak_gflops": 58.7}
