"""The insertion scene: the alignment of the other scene, and an end that tolerances agree on."""

from dataclasses import replace

import numpy as np
import pytest

from model.engine.results import RunResult
from model.events.outcomes import InsertionOutcome, Reason
from model.runs.align import run_once
from model.runs.engine import engine_for
from model.runs.insertion_outcome import insertion_outcomes
from vibralign import INSERTION, Batch, Outcome, Settings, align, simulate

SETS = 96


@pytest.fixture(scope="module")
def batch(device):
    """Random sets of which most align; several do not go in."""
    rng = np.random.default_rng(1023)
    return Batch.stack([
        device.replace(
            half_height=rng.uniform(1.0, 2.0), inertia=rng.uniform(1.0, 4.0),
            tilt_damping=rng.uniform(0.5, 2.0), lateral_damping=rng.uniform(0.1, 0.6),
            press_force=rng.uniform(1.0, 5.0), tilt_stiffness=rng.uniform(5.0, 30.0),
            frequency=rng.uniform(0.3, 3.0), friction=rng.uniform(0.02, 0.3),
            initial_tilt=rng.uniform(0.0, 0.02), contact_damping=rng.uniform(0.5, 2.0),
            lateral_stiffness=rng.uniform(0.3, 2.0), rest_x=rng.uniform(-0.6, 0.6),
        )
        for _ in range(SETS)
    ])  # fmt: skip


@pytest.fixture(scope="module")
def followed(batch):
    return align(batch, scene=INSERTION, horizon=80.0, cores=1)


def test_parts_go_in_and_touch_both_sides(followed):
    inserted = followed.outcome == Outcome.INSERTED
    assert inserted.sum() > SETS // 3
    assert (followed.tau_inserted[inserted] > 0.0).all()
    assert np.isnan(followed.tau_inserted[~inserted]).all()
    assert (followed.side_force_max[inserted] > 0.0).sum() > SETS // 4


def test_a_run_of_this_scene_may_end_at_alignment(batch):
    settings = Settings(horizon=80.0, alignment_only=True)
    rows, tolerances = settings.rows(batch), np.full(SETS, settings.tolerance)
    before, after = (
        RunResult(*engine_for(each)(rows, tolerances).T)
        for each in (settings, replace(settings, scene=INSERTION))
    )
    assert (before.outcome == after.outcome).all()
    assert (before.reason == after.reason).all()
    assert before.tau_align == pytest.approx(after.tau_align, abs=1e-9, nan_ok=True)
    assert Outcome.ALIGNED in after.outcome


def test_aligned_runs_are_followed_into_the_slot(batch, followed):
    settings = Settings(horizon=80.0)
    outcome = run_once(batch, settings)["outcome"]
    ends = insertion_outcomes(batch, outcome, settings)
    aligned = outcome == Outcome.ALIGNED
    assert ((ends == InsertionOutcome.NOT_ALIGNED) == ~aligned).all()
    assert (ends == followed.outcome)[aligned].all()
    assert set(np.unique(ends)) <= set(InsertionOutcome)


def test_depth_and_forces_over_time(device):
    run = simulate(device, scene=INSERTION)
    assert run.outcome is Outcome.INSERTED
    reach = 0.5 * device.press_force
    assert run.depth[-1] == pytest.approx(min(reach, device.half_width), rel=1e-7)
    fallen = run.time > run.tau_align
    forces = np.maximum(run.side_force, run.right_force)[fallen]
    assert forces.max() == pytest.approx(run.side_force_max, rel=0.02)
    assert run.time[-1] == pytest.approx(run.tau_align + run.tau_inserted, rel=1e-12)


def test_a_deeper_insertion_than_the_press_reaches_is_no_insertion(device):
    run = simulate(device, scene=INSERTION, insertion_depth=3.0 * device.press_force, horizon=100.0)
    assert run.outcome in (Outcome.JAMMED, Outcome.HORIZON_REACHED)
    assert np.isnan(run.tau_inserted)
    if run.outcome is Outcome.JAMMED:
        assert run.reason is Reason.LACK_OF_FORCE
        assert "insertion_depth" in run.remedy


def test_a_part_is_inserted_at_the_depth_that_is_set(device):
    settings = Settings(scene=INSERTION, insertion_depth=0.2)
    run = simulate(device, settings)
    assert run.depth[-1] == pytest.approx(0.2, rel=1e-9)
    usual = simulate(device, scene=INSERTION)
    assert usual.depth[-1] > 0.2
    assert run.tau_align == pytest.approx(usual.tau_align, abs=1e-9)
