"""Made-up results of the comparison of methods, for the tests of figures and report."""

import numpy as np
import pytest

from verification.bench.problems import Verdict
from verification.bench.work_precision import Setting

NAN = np.nan
CASES = ("aligned", "sticking", "bouncing", "never_aligning")
HARD = ("base_100_0", "overturning")
ENDS = {"never_aligning": "horizon_reached", "base_100_0": "horizon_reached",
        "overturning": "left_scene"}  # fmt: skip
# (resolution, error, evaluations, verdict, microseconds) of made-up settings, by method and case.
RIGHT, WRONG, SPENT = (
    Verdict.RIGHT_OUTCOME, Verdict.WRONG_OUTCOME, Verdict.TOO_MANY_EVALUATIONS,
)  # fmt: skip
LOCATED = [(1e-3, 1e-4, 500, RIGHT, 50.0), (1e-6, 1e-6, 1000, RIGHT, 80.0),
           (1e-9, 1e-9, 2000, RIGHT, 160.0)]  # fmt: skip
MADE_UP = {
    "taylor_located": {
        **dict.fromkeys((*CASES, "base_100_0"), LOCATED),
        "overturning": [(1e-6, NAN, 1300, RIGHT, 90.0)],
    },
    "rk4_fixed": {
        # The second setting is luck: the third is worse.
        "aligned": [(0.1, 1e-2, 40, RIGHT, 2.0), (0.01, 1e-9, 400, RIGHT, 20.0),
                    (0.005, 1e-4, 800, RIGHT, 40.0), (0.001, 9e-6, 4000, RIGHT, 200.0)],
        "sticking": [(0.1, 1e-1, 40, RIGHT, 2.0), (0.001, NAN, 4000, SPENT, NAN)],
        "base_100_0": [(0.001, 3e-4, 8000, RIGHT, 400.0)],
        "overturning": [(0.001, NAN, 900, WRONG, NAN)],
    },
    "semi_implicit_euler_fixed": {
        "aligned": [(0.001, 1e-6, 8000, RIGHT, 400.0)],
        "overturning": [(0.001, NAN, 40_001, SPENT, NAN)],
        "bouncing": [(0.1, NAN, 900, WRONG, NAN), (0.01, 2e-3, 9000, RIGHT, 500.0)],
    },
}  # fmt: skip


@pytest.fixture(scope="session")
def timed_settings() -> list[Setting]:
    """Made-up settings: only the located method gets to 1e-8; RK4 to 1e-5 in one case.

    The hard cases of the study among them: of the second one only the outcome can be compared.
    """
    return [
        Setting(case, ENDS.get(case, "aligned"), 1e-12, 8, method, resolution, error, evaluations,
                verdict, microseconds)
        for method, by_case in MADE_UP.items()
        for case, ladder in by_case.items()
        for resolution, error, evaluations, verdict, microseconds in ladder
    ]  # fmt: skip
