"""A part that slides off its left edge: then its corner B2 is as deep behind the wall as A2 was.

It comes out, or is pushed further in, at every tolerance and so at every length of the steps.
"""

from math import cos, sin

import numpy as np
import pytest

from model.events.outcomes import Outcome, Reason
from model.physics.modes import CLOSED, OPEN, START
from model.physics.notation import LEFT_EDGE

TILT, DEPTH = -0.07, 0.01
TOLERANCES = [1e-4, 1e-7, 1e-10, 1e-13]


@pytest.fixture
def beside_a2(device):
    """State with A2 at ``along`` on the bottom face and ``DEPTH`` behind it; x moves at ``rate``.

    ``behind`` moves the part to the left.
    """

    def make(along, rate, behind=0.0):
        height = DEPTH - device.half_height
        x = -device.slot_half_width - along * cos(TILT) + height * sin(TILT)
        y = -along * sin(TILT) - height * cos(TILT)
        return np.array([x - behind, y, TILT, rate, 0.0, 0.0])

    return make


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_it_comes_out_and_aligns(stepped_run, device, beside_a2, tolerance):
    p = device.replace(friction=0.0)
    mode = START._replace(edge=LEFT_EDGE)
    run = stepped_run(
        p, beside_a2(1e-3 - p.half_width, 0.5), mode, horizon=1.0, tolerance=tolerance
    )  # fmt: skip
    (end,) = run.mode_changes("face", CLOSED, OPEN)
    assert run.tau_align > end.end
    # From where A2 left it, B2 has DEPTH sin |φ| to go.
    way = DEPTH * sin(-TILT)
    assert run.tau_align - end.end == pytest.approx(way / 0.5, rel=0.2)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_what_moves_further_in_leaves_the_scene(stepped_run, device, beside_a2, tolerance):
    state = beside_a2(-device.half_width, -0.5, behind=-1e-4)
    run = stepped_run(
        device, state, START._replace(face=OPEN), horizon=1.0, tolerance=tolerance
    )  # fmt: skip
    assert (run.outcome, run.reason) == (Outcome.LEFT_SCENE, Reason.CORNER_ON_WALL)
    assert run.time[-1] == 0.0
