"""Made-up errors and costs, for the tests of bench and report."""

import numpy as np
import pytest

from verification.bench.problems import Verdict
from verification.bench.work_precision import Setting

NAN = np.nan
CASES = ("aligned", "sticking", "bouncing", "never_aligning")
ENDS = {"never_aligning": "horizon_reached", "base_100_0": "horizon_reached",
        "overturning": "left_scene", "slow": "horizon_reached"}  # fmt: skip
# (tolerance, error, evaluations, verdict, microseconds) of made-up settings, by case.
RIGHT, WRONG, SPENT = (
    Verdict.RIGHT_OUTCOME, Verdict.WRONG_OUTCOME, Verdict.TOO_MANY_EVALUATIONS,
)  # fmt: skip
USUAL = [(1e-3, 1e-4, 500, RIGHT, 50.0), (1e-6, 1e-6, 1000, RIGHT, 80.0),
         (1e-9, 1e-9, 2000, RIGHT, 160.0)]  # fmt: skip
MADE_UP = {
    **dict.fromkeys(CASES, USUAL),
    # The second setting is luck: the third is worse.
    "aligned": [(1e-2, 1e-2, 40, RIGHT, 2.0), (1e-3, 1e-9, 400, RIGHT, 20.0),
                (1e-4, 1e-4, 800, RIGHT, 40.0), (1e-9, 9e-9, 4000, RIGHT, 200.0)],
    "base_100_0": [(1e-3, NAN, 900, WRONG, NAN), (1e-6, 3e-4, 9000, RIGHT, 500.0)],
    "overturning": [(1e-6, NAN, 1300, RIGHT, 90.0)],
    "slow": [(1e-6, NAN, 40_001, SPENT, NAN)],
}  # fmt: skip


@pytest.fixture(scope="session")
def timed_settings() -> list[Setting]:
    """Made-up settings; the hard cases of the study among them keep no error."""
    return [
        Setting(case, ENDS.get(case, "aligned"), 1e-12, 8, tolerance, error, evaluations,
                verdict, microseconds)
        for case, ladder in MADE_UP.items()
        for tolerance, error, evaluations, verdict, microseconds in ladder
    ]  # fmt: skip
