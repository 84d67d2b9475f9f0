"""Comparison of maps with full grids: wrong cells, and growth of the cost."""

import numpy as np
import pytest

from benchmarks.maps import compare, compare_reliability, costs, drawn, judge, slope
from model.events.outcomes import Outcome
from model.study.config import RunSettings, Span, load_study, study_path
from model.study.maps.compute import duration_scale
from model.study.maps.lattice import BESIDE, refine
from model.study.maps.plan import map_plan, plan_of

CELLS = 256
ALIGNED, SETTLED = int(Outcome.ALIGNED), int(Outcome.SETTLED)


@pytest.fixture
def plan(device):
    x = Span(parameter="tilt_stiffness", start=2.0, stop=16.0)
    y = Span(parameter="press_force", start=1.0, stop=9.0)
    settings = RunSettings(readings="consistent", horizon=40.0, tolerance=1e-8)
    return plan_of("fig13", device, settings, (x, y), CELLS, None)


def areas():
    rows, columns = np.indices((CELLS + 1, CELLS + 1))
    area = np.where(columns > 100 + 0.3 * rows, ALIGNED, SETTLED).astype(np.int8)
    tau = np.where(area == ALIGNED, 5.0, np.nan)
    return area, tau


def refined(plan, area, tau):
    def evaluate(rows, columns):
        value = duration_scale(plan, rows, columns, tau[rows, columns])
        return area[rows, columns].astype(np.int64), value

    return refine(evaluate, plan.lattice)


def test_a_map_that_agrees_has_nothing_wrong(plan):
    area, tau = areas()
    found = judge(plan, refined(plan, area, tau), area, tau, (10.0, 1.0))
    assert (found.wrong, found.wrong_unflagged, found.failed, found.off) == (0, 0, 0, 0.0)
    assert 0.0 < found.computed < 0.4
    assert (
        0.0 < found.flagged < 1.3 * 2.0 * BESIDE / CELLS
    )  # 1.3 columns of the border a row, two sides
    assert "10.00 % of the time; 0 wrong" in found.words()


def test_a_wrong_node_counts_whether_flagged_or_not_and_a_failed_run_does_not(plan):
    area, tau = areas()
    map_ = refined(plan, area, tau)
    filled = np.argwhere(~map_.computed & ~map_.flagged & (area == ALIGNED))
    beside = np.argwhere(map_.beside(BESIDE) & (area == ALIGNED))
    full, durations = area.copy(), tau.copy()
    full[tuple(filled[0])] = SETTLED
    full[tuple(beside[0])] = SETTLED
    full[tuple(filled[9])] = int(Outcome.FAILED)
    durations[full != ALIGNED] = np.nan
    durations[tuple(filled[-1])] = 9.0
    found = judge(plan, map_, full, durations, (10.0, 1.0))
    assert (found.wrong, found.wrong_unflagged, found.failed) == (2, 1, 1)
    assert found.off == pytest.approx(1.0 / np.isfinite(durations).sum())


def test_the_slope_is_the_power_of_the_cost():
    assert slope({128: 100, 256: 200, 512: 400}) == pytest.approx(1.0)
    assert slope({128: 100, 256: 400, 512: 1600}) == pytest.approx(2.0)


def test_small_maps_are_compared_and_costed():
    """Of the study, and of devices that are drawn: one that aligns at no corner, and one at two."""
    study = load_study(study_path())
    for plan, aligns in zip(drawn(study, 4, count=2), (0.0, 0.5), strict=True):
        found = compare(plan)
        assert (found.wrong, found.computed) == (0, 1.0)
        assert found.seconds_full > 0.0
        assert plan.baseline.friction != map_plan(study, plan.name).baseline.friction
        reliability = compare_reliability(plan)
        assert reliability.cells == 1
        assert (reliability.wrong, reliability.too_good) == (0, 0)
        assert (reliability.reliable, reliability.refined) == (aligns, 4)
        assert aligns / 2.0 <= reliability.tried <= aligns * 31.0 / 32.0  # every phase, once
    assert costs("fig14", 4, 2) == {2: 9, 4: 25}
