"""A part over the left edge moves as the mirror image of one over the right edge, to the bit.

The scene has a contact that its mirror image lacks, A2 on the left side face: runs are compared up
to this contact or an alignment.
"""

from itertools import takewhile

import numpy as np
import pytest

from model.physics.modes import OPEN
from model.physics.motion import is_supported

FLIP = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0])  # x, φ and their rates

# What the motion is made of, how often it switches at least, and whether the corner B1 lands.
RUNS = {
    "lift-offs": ({"frequency": 10.0, "tilt_stiffness": 5.0, "rest_tilt": 0.01}, 10, False),
    "lands on its corner": (
        {
            "press_force": 0.7, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.4,
            "misalignment": 1.0, "rest_tilt": -0.02,
        }, 80, True,
    ),
}  # fmt: skip


def mirrored(mode):
    return mode._replace(edge=-mode.edge, support_slip=-mode.support_slip)


def what_matters(mode):
    slip = mode.support_slip if is_supported(mode) else None
    return mode.edge, mode.face, mode.corner, slip


@pytest.mark.parametrize(("changes", "least", "lands"), RUNS.values(), ids=list(RUNS))
def test_a_mirrored_run_is_the_mirror_image(stepped_run, device, changes, least, lands):
    p = device.replace(**changes)
    p = p.replace(rest_x=p.misalignment)
    right = stepped_run(p, horizon=20.0)
    start = right.steps[0]
    image = p.replace(rest_x=-p.rest_x, rest_tilt=-p.rest_tilt)
    left = stepped_run(image, FLIP * start.state, mirrored(start.mode), horizon=20.0)
    common = list(
        takewhile(
            lambda step: step.end_mode.side == OPEN and not step.end_mode.dropped, right.steps
        )
    )
    assert sum(step.mode != step.end_mode for step in common) >= least
    assert any(step.end_mode.corner != OPEN for step in common) is lands
    # A step's length depends on the places of both sides, which round differently.
    events, others = (
        [step for step in steps if step.mode != step.end_mode] for steps in (common, left.steps)
    )
    for one, other in zip(events, others, strict=False):
        assert what_matters(other.end_mode) == what_matters(mirrored(one.end_mode))
        assert other.end == pytest.approx(one.end, abs=1e-9)
        assert FLIP * other.end_state == pytest.approx(one.end_state, abs=1e-8)
    assert len(others) >= len(events)
