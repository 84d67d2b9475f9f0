"""Made-up results of the comparison of methods, for the tests of figures and report."""

import numpy as np
import pytest
import xarray as xr

from benchmarks import fixed_steps
from benchmarks.fixed_steps import FIXED_SCHEMES, Wrong
from benchmarks.hard_cases import BATCH, Judged, Mark
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from benchmarks.work_precision import TimedSetting

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
def timed_settings() -> list[TimedSetting]:
    """Made-up settings: only the located method gets to 1e-8; RK4 to 1e-5 in one case."""
    return [
        TimedSetting(case, method, resolution, error, evaluations, verdict, microseconds, 8)
        for method, by_case in MADE_UP.items()
        for case, ladder in by_case.items()
        for resolution, error, evaluations, verdict, microseconds in ladder
    ]


def _made_up(figure: str, kind: str, names: tuple[str, str], located: np.ndarray) -> xr.Dataset:
    tau = np.tile(located, (2, 2, 1, 1))
    tau[0, 0, 0, :2] += 0.5  # RK4, coarse: two wrong times and
    tau[0, 0, 1, 0] = NAN  # one wrong outcome
    tau[0, 1, 1, 3] = 2.0  # RK4, fine: aligns where it should not
    sensitive = np.zeros(located.shape, np.int8)
    sensitive[0, 0] = 1
    schemes = {"flag_meanings": " ".join(FIXED_SCHEMES)}
    return xr.Dataset(
        {
            "tau_align": (("scheme", "step", *names), tau),
            "wrong": (("scheme", "step", *names), fixed_steps.judged(tau, located, 0.1)),
            "tau_located": (names, located),
            "sensitive": (names, sensitive),
        },
        {
            "scheme": ("scheme", [0, 1], schemes),
            "step": ("step", [0.01, 0.001]),
            **{
                name: (name, np.arange(1.0, 1.0 + size), {"long_name": name})
                for name, size in zip(names, located.shape, strict=True)
            },
        },
        {"figure": figure, "figure_kind": kind, "tau_tolerance": 0.1},
    )


@pytest.fixture(scope="session")
def wrong_datasets() -> dict[str, xr.Dataset]:
    """Two made-up figures of eight points, of which RK4 gets three wrong, then one."""
    located = np.array([[5.0, 4.0, 3.5, 3.0], [6.0, 5.0, 4.5, NAN]])
    made = {
        "fig06": _made_up("fig06", "curves", ("tilt_stiffness", "press_force"), located),
        "fig13": _made_up("fig13", "map", ("press_force", "tilt_stiffness"), located),
    }
    for dataset in made.values():
        wrong = dataset["wrong"].values
        assert (wrong[0, 0] != Wrong.NOT_WRONG).sum() == 3
        assert (wrong[0, 1] != Wrong.NOT_WRONG).sum() == 1
    return made


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
