"""A mistake in the engine is caught by its tests, or by those against other solutions.

Each mutation is one edit of a copy of the package, on which the tests run until one fails.
"""

# ruff: noqa: E501 - a line is a case

from pathlib import Path

import pytest

from tests.model.mutations import assert_caught, run_on_copy

TESTS = [
    "tests/model/engine/test_series.py",
    "tests/model/engine/test_carried_error.py",
    "tests/model/runs/test_not_finite.py",
    "tests/verification/test_independent.py",
]

# mutation: (file below src/model/engine, what stands there once, what is put in its place)
MUTATIONS = {
    # --- series and their errors
    "the error of a cosine has the sine's sign": ("series_code.py", 'self.do("fneg", total) if series == self.layout.sines[1] else total', "total"),
    "a root is divided by itself, once": ("series_code.py", 'self.do("fdiv", rest, self.do("fadd", first, first))', 'self.do("fdiv", rest, first)'),
    "displaced runs meet events at once": ("carried_error.py", "jump), -late, rates_after)", "jump), 0.0 * late, rates_after)"),
    # --- detection and location of events
    "levels are straight": ("step.py", "return CURVATURE * w[", "return 0.0 * w["),
    "a level that ends above zero was there": ("step.py", "(min(left, right) > bound)", "(max(left, right) > bound)"),
    "not a number is a step": ("step.py", "step + _nothing(lanes, w, i)", "step"),
    "a zero is the secant's": ("event_search.py", "_ROOT_ITERATIONS = 60", "_ROOT_ITERATIONS = 0"),
    "one sign of an absolute value": ("event_search.py", "if has_absolute(lanes, which, w, lane):", "if False:"),
    "corners stand behind walls": ("levels.py", 'places["right_corner_x"] - p.slot_half_width', 'places["right_corner_x"] + p.slot_half_width'),
    # --- results
    "peaks are at nodes": ("peaks.py", "if left < until and max(", "if False and max("),
}  # fmt: skip


@pytest.mark.nightly
@pytest.mark.parametrize("mutation", MUTATIONS)
def test_a_test_catches_it(tmp_path: Path, mutation: str) -> None:
    assert_caught(run_on_copy(tmp_path, "engine", MUTATIONS[mutation], TESTS))


@pytest.mark.nightly
def test_without_a_mutation_no_test_fails(tmp_path: Path) -> None:
    run = run_on_copy(tmp_path, "engine", None, TESTS)
    assert run.returncode == pytest.ExitCode.OK, run.stdout + run.stderr
