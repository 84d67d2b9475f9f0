"""Whole runs against mechanics: closed forms and static equilibrium.

The energy of runs is balanced in tests/model/closed_forms/test_energy.py.
"""

from math import cos, sin, sqrt

import numpy as np
import pytest

from vibralign import SUSPENDED, Outcome, simulate

"""sin(ντ + phase) = 0 for ever: no excitation."""


# ------------------------------------------------------------------------- no contact: closed forms


@pytest.fixture
def lifted(device):
    """Lifted off the base by a press force of -20: the axial spring pulls it up to b + 20."""
    return device.replace(
        press_force=-20.0, frequency=1.7, phase=0.4, rest_x=1.0, rest_tilt=0.2, initial_tilt=0.05
    )


def free_oscillation(time, offset, mass, damping, stiffness):
    """Underdamped m z'' + h z' + k z = 0 from z = offset at rest."""
    decay = damping / (2 * mass)
    omega = sqrt(stiffness / mass - decay**2)
    turn = np.cos(omega * time) + decay / omega * np.sin(omega * time)
    return offset * np.exp(-decay * time) * turn


def test_suspended_part_follows_the_closed_forms(lifted):
    run = simulate(lifted, scene=SUSPENDED, horizon=2.5)  # it swings up and never comes back
    assert run.outcome is Outcome.HORIZON_REACHED
    time, p = run.time, lifted

    # φ: I z'' + h z' + k z = 0 with z = φ - φ_st.
    tilt = p.rest_tilt + free_oscillation(
        time, p.initial_tilt - p.rest_tilt, p.inertia, p.tilt_damping, p.tilt_stiffness
    )
    # x: overdamped, k_x < h_x²/4: two decaying exponentials from rest.
    half, gap = p.lateral_damping / 2, sqrt(p.lateral_damping**2 / 4 - p.lateral_stiffness)
    slow, fast = -half + gap, -half - gap
    offset = p.misalignment - p.rest_x
    x = p.rest_x + offset * (fast * np.exp(slow * time) - slow * np.exp(fast * time)) / (
        fast - slow
    )
    # y: z'' + h z' + z = -sin(ντ + phase), z = y - (b - f0). A solution is Im(Y e^{i(ντ + phase)}),
    # Y = -1 / (1 - ν² + i h ν), plus the free motion that meets the start at rest.
    nu, h = p.frequency, p.axial_damping
    wave = -1.0 / complex(1.0 - nu**2, h * nu)
    forced = (wave * np.exp(1j * (nu * time + p.phase))).imag
    start_forced = (wave * np.exp(1j * p.phase)).imag
    start_rate = (1j * nu * wave * np.exp(1j * p.phase)).imag
    # The start's height: the bottom face passes through A1.
    r_x = p.slot_half_width - p.misalignment
    y0 = (p.half_height - r_x * sin(p.initial_tilt)) / cos(p.initial_tilt)
    offset = y0 - (p.half_height - p.press_force) - start_forced
    omega = sqrt(1.0 - h**2 / 4)
    free = offset * np.cos(omega * time) + (h / 2 * offset - start_rate) / omega * np.sin(
        omega * time
    )
    y = p.half_height - p.press_force + np.exp(-h / 2 * time) * free + forced

    # Tolerance 1e-10 a step and some tens of steps of a stable linear motion of size 40.
    assert run.state[:, 0] == pytest.approx(x, abs=1e-8)
    assert run.state[:, 1] == pytest.approx(y, abs=1e-8)
    assert run.state[:, 2] == pytest.approx(tilt, abs=1e-8)
    assert y[-1] > y0 + 10
    assert not run.contact_force.any()


# ------------------------------------------------------------------------------- static equilibrium
