"""Numbers that leave the range of floats: a run goes on in numbers, or fails and says so."""

from dataclasses import replace

import numpy as np
import pytest

from vibralign import Outcome, Parameters, Reason, align

FLUSH = Parameters(
    half_width=1.0, half_height=1.3, clearance=0.09, misalignment=0.05, initial_tilt=0.0,
    inertia=1.0, lateral_stiffness=1.0, tilt_stiffness=10.0, lateral_damping=0.1,
    axial_damping=0.1, tilt_damping=0.1, contact_damping=0.0, friction=0.1, press_force=1.9,
    frequency=10.0, rest_x=2.0, rest_y=0.0,
)  # fmt: skip


def test_a_part_that_touches_flush_on_an_undamped_base_goes_on_in_numbers():
    # The loads of A1 and B1 begin together: their shares in the friction are 0 / 0.
    run = align([FLUSH], scene="insertion", horizon=30.0, cores=1)
    assert run.reason[0] not in (Reason.NOT_FINITE, Reason.STEP_TOO_SMALL)
    assert np.isfinite([run.tilt_max[0], run.contact_force_max[0]]).all()


@pytest.mark.parametrize(
    ("name", "value"),
    [("friction", 1e300), ("contact_stiffness", 1e300), ("inertia", 1e-300), ("frequency", 1e30)],
)
def test_a_run_beyond_floats_fails_at_once(device, name, value):
    run = align([replace(device, **{name: value})], horizon=5.0, cores=1)
    assert run.outcome[0] == Outcome.FAILED
    assert run.reason[0] in (Reason.NOT_FINITE, Reason.STEP_TOO_SMALL)
    assert run.rhs_evaluations[0] < 10_000
