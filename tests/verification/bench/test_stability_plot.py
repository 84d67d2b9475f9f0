"""The picture of all methods on all cases shows what the table says."""

import math

import pytest
from matplotlib.colors import to_hex

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.report.stability_plot import (
    FILLS,
    INACCURATE,
    KEPT,
    OUTCOME,
    cell,
    stability,
)
from verification.bench.work_precision import Setting

NAN = math.nan


def setting(error: float, evaluations: int = 1, verdict: Verdict = Verdict.RIGHT_OUTCOME):
    return Setting("a", "aligned", 1e-12, 2, "rk4_fixed", 0.1, error, evaluations, verdict)


def test_every_ladder_has_a_cell(timed_settings):
    titles = {"aligned": "slides", "base_100_0": "base k_a = 100", "overturning": "tilts"}
    shown = [each for each in timed_settings if each.case in titles]
    (axes,) = (figure := stability(shown, titles)).axes
    cells = {
        (list(METHODS)[int(patch.get_x())], list(titles)[int(patch.get_y())]): (
            text.get_text(), to_hex(patch.get_facecolor()).upper(),
        )
        for patch, text in zip(axes.patches, axes.texts, strict=True)
    }  # fmt: skip
    assert cells == {
        ("taylor_located", "aligned"): ("1.0k", FILLS[KEPT]),
        ("rk4_fixed", "aligned"): ("4.0k", FILLS[KEPT]),
        ("scipy_rk45", "aligned"): ("900", FILLS[KEPT]),
        ("taylor_located", "base_100_0"): ("1.0k", FILLS[KEPT]),
        ("rk4_fixed", "base_100_0"): ("3·10⁻⁴", FILLS[INACCURATE]),
        ("taylor_located", "overturning"): ("·", FILLS[OUTCOME]),
        ("rk4_fixed", "overturning"): ("W", FILLS["W: wrong outcome"]),
        ("scipy_rk45", "overturning"): ("N", FILLS["N: over its limit"]),
    }
    assert [text.get_text() for text in figure.legends[0].get_texts()] == list(FILLS)
    assert axes.get_yticklabels()[1].get_text() == "base $k_a$ = 100"


@pytest.mark.parametrize(
    ("ladder", "needed", "expected"),
    [
        ([], setting(1e-6, 999), ("999", KEPT)),
        ([], setting(1e-6, 9_949), ("9.9k", KEPT)),
        ([], setting(1e-6, 84_500), ("84k", KEPT)),
        ([], setting(1e-6, 14_397_736), ("14M", KEPT)),
        ([setting(NAN), setting(3e-4), setting(2e-3)], None, ("3·10⁻⁴", INACCURATE)),
        ([setting(20.0)], None, ("20", INACCURATE)),
        ([setting(NAN)], None, ("·", OUTCOME)),
        ([setting(NAN, 1, Verdict.WRONG_OUTCOME)], None, ("W", "W: wrong outcome")),
        ([setting(NAN, 1, Verdict.FAILED)], None, ("F", "F: fails")),
        ([setting(NAN, 1, Verdict.TOO_MANY_EVALUATIONS)], None, ("N", "N: over its limit")),
    ],
)
def test_a_cell_tells_the_cost_or_what_is_missing(ladder, needed, expected):
    assert cell(ladder, needed) == expected
