"""Events at one instant: those due to rounding alone are stepped over, others end the run."""

import numpy as np
import pytest

from model.engine.lifecycle import skip_chatter
from model.engine.record import AT, SIZE, STATE
from model.engine.start import begin
from model.physics.modes import OPEN, START
from model.physics.notation import STATE_SIZE
from verification.fuzz import SETTINGS, draw
from vibralign import Batch, Reason, Settings, Variants, align


@pytest.mark.parametrize("number", [1844, 4419, 5677, 7856, 9260])
def test_sets_that_once_chattered_come_on(number):
    # Parts of hardly any inertia on hard bases, where rounding of a length causes a load; and one
    # part that is pressed only later, without load or force along the face at the start.
    run = align(draw(2007, number, 1), SETTINGS, cores=1)
    assert run.reason[0] in (Reason.NONE, Reason.TOO_MANY_EVALUATIONS)


@pytest.fixture
def standing(device):
    """A run at its start, after a number of events in the same instant."""

    def make(at_once):
        settings = Settings(horizon=1.0)
        scene, control = settings.for_kernels
        runs = np.zeros((1, SIZE))
        row = Batch.stack([device]).constants(Variants())[0]
        begin(row, settings.tolerance, scene, control, runs, 0)
        runs[0, AT.events_at_once] = at_once
        return runs

    return make


@pytest.mark.parametrize(
    ("at_once", "before", "moment"),
    [
        (17, START, 2e-12),
        (30, START._replace(face=OPEN), 1e-12 * 2.0**14),  # the contact makes no difference yet
        (50, START._replace(face=OPEN), 0.0),  # in a longer moment it does
        (62, START, 0.0),  # beyond the horizon
    ],
)
def test_a_moment_passes_if_it_makes_no_difference_which_mode_holds(
    standing, at_once, before, moment
):
    scene, _ = Settings().for_kernels
    runs = standing(at_once)
    state = runs[0, STATE : STATE + STATE_SIZE].copy()
    skip_chatter(scene, before, runs, 0)
    assert runs[0, AT.time] == pytest.approx(moment, rel=1e-12)
    assert np.array_equal(runs[0, STATE : STATE + STATE_SIZE], state) is (moment == 0.0)
    assert runs[0, AT.rhs_evaluations] < 20
