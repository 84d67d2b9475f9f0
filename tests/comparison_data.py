"""Made-up results of the comparison of methods, for the tests of figures and report."""

import numpy as np
import pytest

from benchmarks.hard_cases import BATCH, Judged, Mark
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.work_precision import Setting

NAN = np.nan
CASES = ("aligned", "sticking", "bouncing", "never_aligning")
# (resolution, error, evaluations, verdict, microseconds) of made-up settings, by method and case.
RIGHT, WRONG, SPENT = (
    Verdict.RIGHT_OUTCOME, Verdict.WRONG_OUTCOME, Verdict.TOO_MANY_EVALUATIONS,
)  # fmt: skip
LOCATED = [(1e-3, 1e-4, 500, RIGHT, 50.0), (1e-6, 1e-6, 1000, RIGHT, 80.0),
           (1e-9, 1e-9, 2000, RIGHT, 160.0)]  # fmt: skip
MADE_UP = {
    "dop853_located": dict.fromkeys(CASES, LOCATED),
    "rk4_fixed": {
        # The second setting is luck: the third is worse.
        "aligned": [(0.1, 1e-2, 40, RIGHT, 2.0), (0.01, 1e-9, 400, RIGHT, 20.0),
                    (0.005, 1e-4, 800, RIGHT, 40.0), (0.001, 9e-6, 4000, RIGHT, 200.0)],
        "sticking": [(0.1, 1e-1, 40, RIGHT, 2.0), (0.001, NAN, 4000, SPENT, NAN)],
    },
    "scipy_rk45": {
        "aligned": [(1e-6, 1e-6, 900, RIGHT, 4000.0)],
        "bouncing": [(1e-3, NAN, 900, WRONG, NAN), (1e-6, 2e-3, 9000, RIGHT, 50000.0)],
    },
}  # fmt: skip


@pytest.fixture(scope="session")
def timed_settings() -> list[Setting]:
    """Made-up settings: only the located method gets to 1e-8; RK4 to 1e-5 in one case."""
    return [
        Setting(case, method, resolution, error, evaluations, verdict, 8, microseconds)
        for method, by_case in MADE_UP.items()
        for case, ladder in by_case.items()
        for resolution, error, evaluations, verdict, microseconds in ladder
    ]


@pytest.fixture(scope="session")
def judged() -> list[Judged]:
    """Made-up marks of two cases of the study: only the first method is stable on both."""
    made = []
    for case, error in (("base_100_0", 1e-3), ("overturning", NAN)):
        for method in METHODS:
            stable, spent = method == "dop853_located", method.startswith("scipy")
            verdict = RIGHT if stable else SPENT if spent else WRONG
            mark = Mark.STABLE if stable else Mark.OVER_BUDGET if spent else Mark.INACCURATE
            if method == "rk4_fixed" and case == "base_100_0":
                verdict = RIGHT
            known = error if verdict == RIGHT else NAN
            outcome = "left_scene" if case == "overturning" else "horizon_reached"
            made.append(Judged(case, method, outcome, verdict, mark, known, 1e-9, 1000, 50.0))
    alone = ("base_100_0", BATCH, "horizon_reached", RIGHT, Mark.STABLE, 2e-3, 1e-9, 17_000)
    return [*made, Judged(*alone, microseconds=900.0)]
