"""A horizon of 100,000 periods: the phase of the excitation must not drift.

A pressed part that cannot tilt, without friction, is a linear oscillator on base and axial spring.
After the transient it has the forced motion Im(Y e^(iντ)), Y = -1/(k_a + 1 - ν² + iν(h_a + h_y)).
"""

from math import pi

import numpy as np
import pytest

from verification.bench.problems import last_state
from vibralign import Batch, Outcome, Settings


def test_after_100000_periods_the_phase_is_still_right(device):
    frequency = 100.0
    p = device.replace(
        inertia=1e15, initial_tilt=0.0, misalignment=device.slot_half_width, friction=0.0,
        lateral_stiffness=0.0, tilt_stiffness=0.0, tilt_damping=0.0, frequency=frequency,
        contact_stiffness=100.0, contact_damping=1.0, press_force=20.0,
    )  # fmt: skip
    horizon = (1e5 + 0.3) * 2 * pi / frequency
    settings = Settings(horizon=horizon, may_settle=False, tolerance=1e-9)
    (row,) = settings.rows(Batch.stack([p]))
    result, state = last_state(settings, row, settings.tolerance)
    assert Outcome(int(result.outcome)) is Outcome.HORIZON_REACHED
    wave = -1.0 / complex(101.0 - frequency**2, frequency * (1.0 + p.axial_damping))
    wave *= np.exp(1j * frequency * horizon)
    depth = 20.0 / 101.0
    # Its own errors decay with it; ντ, of 6e5, has a rounding of 1e-10.
    assert state[1] == pytest.approx(p.half_height - depth + wave.imag, abs=1e-8)
    assert state[4] == pytest.approx(frequency * wave.real, abs=1e-7)
