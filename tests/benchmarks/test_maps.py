"""Comparison of maps with full grids: wrong nodes, and the share of the trajectories."""

import json

import numpy as np
import pytest

from benchmarks import maps
from benchmarks.maps import coarse_plan, compare, judge
from model.events.outcomes import Outcome
from model.study.config import RunSettings, Span, load_study, study_path
from model.study.maps.compute import duration_scale
from model.study.maps.lattice import BESIDE, refine
from model.study.maps.plan import plan_of

CELLS = 256
ALIGNED, SETTLED = int(Outcome.ALIGNED), int(Outcome.SETTLED)


@pytest.fixture
def plan(device):
    x = Span(parameter="tilt_stiffness", start=2.0, stop=16.0)
    y = Span(parameter="press_force", start=1.0, stop=9.0)
    settings = RunSettings(readings="consistent", horizon=40.0, tolerance=1e-8)
    return plan_of("fig13", device, settings, (x, y), CELLS, None)


@pytest.fixture
def area():
    rows, columns = np.indices((CELLS + 1, CELLS + 1))
    return np.where(columns > 100 + 0.3 * rows, ALIGNED, SETTLED).astype(np.int8)


def refined(plan, area):
    tau = np.where(area == ALIGNED, 5.0, np.nan)

    def evaluate(rows, columns):
        value = duration_scale(plan, rows, columns, tau[rows, columns])
        return area[rows, columns].astype(np.int64), value

    return refine(evaluate, plan.lattice)


def test_a_map_that_agrees_has_nothing_wrong(plan, area):
    found = judge(plan, refined(plan, area), area)
    assert (found.wrong, found.wrong_unflagged, found.failed) == (0, 0, 0)
    assert 0.0 < found.computed < 0.4
    assert (
        0.0 < found.flagged < 1.3 * 2.0 * BESIDE / CELLS
    )  # 1.3 columns of the border a row, two sides
    assert "% of the trajectories; 0 wrong, of these 0 not flagged" in str(found)


def test_a_wrong_node_counts_whether_flagged_or_not_and_a_failed_run_does_not(plan, area):
    map_ = refined(plan, area)
    filled = np.argwhere(~map_.computed & ~map_.flagged & (area == ALIGNED))
    beside = np.argwhere(map_.beside(BESIDE) & (area == ALIGNED))
    full = area.copy()
    full[tuple(filled[0])] = SETTLED
    full[tuple(beside[0])] = SETTLED
    full[tuple(filled[9])] = int(Outcome.FAILED)
    found = judge(plan, map_, full)
    assert (found.wrong, found.wrong_unflagged, found.failed) == (2, 1, 1)


def test_small_maps_are_compared_and_kept(tmp_path):
    study = load_study(study_path())
    found = compare(coarse_plan(study, "fig14", 4))
    assert (found.wrong, found.computed) == (0, 1.0)
    said = []
    maps.report(2, tmp_path, said.append)
    kept = json.loads((tmp_path / "maps.json").read_text())
    assert [each["figure"] for each in kept] == list(study.map_names)
    assert len(said) == len(kept)
    assert {each["wrong"] for each in kept} == {0}
