"""Whole runs against mechanics: closed forms, conserved energy, dissipation, static equilibrium."""

from math import cos, hypot, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import root

from model import SUSPENDED, Outcome, simulate

UNDAMPED = {"lateral_damping": 0.0, "axial_damping": 0.0, "tilt_damping": 0.0}
STILL = {"frequency": 0.0, "phase": 0.0}
"""sin(ντ + phase) = 0 for ever: no excitation."""


def depth(parameters, state):
    """Depth of A1 behind the bottom face, b + (A1 - C)·e_n, for states of shape (n, 6)."""
    x, y, tilt = state.T[:3]
    r_x = parameters.slot_half_width - x
    return parameters.half_height - r_x * np.sin(tilt) - y * np.cos(tilt)


def side_depth(parameters, state):
    """Depth of A2 behind the left side, a + (A2 - C)·e_t."""
    x, y, tilt = state.T[:3]
    r_x = -parameters.slot_half_width - x
    return parameters.half_width + r_x * np.cos(tilt) - y * np.sin(tilt)


def energy(parameters, state, edge=True):
    """Kinetic energy, springs, press force, and the base where A1 and A2 are pushed in.

    Valid as long as A1 stands under the bottom face, and A2 meets the part through its left side.
    """
    x, y, tilt, dx, dy, dtilt = state.T
    p = parameters
    rest_x = p.misalignment if p.rest_x is None else p.rest_x
    rest_y = p.half_height if p.rest_y is None else p.rest_y
    motion = dx**2 + dy**2 + p.inertia * dtilt**2
    springs = p.lateral_stiffness * (x - rest_x) ** 2 + (y - rest_y) ** 2
    springs = springs + p.tilt_stiffness * (tilt - p.rest_tilt) ** 2
    base = 0.0
    if edge:
        pushed = [np.maximum(depths(p, state), 0.0) ** 2 for depths in (depth, side_depth)]
        base = p.contact_stiffness * sum(pushed)
    return 0.5 * (motion + springs + base) + p.press_force * y


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


def test_suspended_part_without_damping_keeps_its_energy(lifted):
    p = lifted.replace(**UNDAMPED, **STILL)
    run = simulate(p, scene=SUSPENDED, horizon=6.0)  # back down after 2π: not yet
    total = energy(p, run.state, edge=False)
    # 1e-10 a step relative to 1 + |state|, velocities and distances of up to 20, some ten steps.
    assert np.ptp(total) < 1e-6
    kinetic = 0.5 * (run.state[:, 3:5] ** 2).sum(axis=1)
    assert np.ptp(kinetic) > 100  # energy did move


# ---------------------------------------------------------------------------------- edge contact


CONSERVATIVE = {**UNDAMPED, **STILL, "contact_damping": 0.0, "friction": 0.0}


@pytest.mark.parametrize("tilt", [0.001, 0.05, 0.15])
@pytest.mark.parametrize("press_force", [0.5, 3.0])
def test_elastic_edge_contact_keeps_the_energy_through_lift_offs(device, tilt, press_force):
    p = device.replace(**CONSERVATIVE, initial_tilt=tilt, press_force=press_force)
    run = simulate(p, may_settle=False, horizon=20.0)
    # Until the edge leaves the face, when what is stored in the base is lost.
    end = run.tau_align if run.outcome is Outcome.ALIGNED else run.time[-1]
    before = run.time < end
    total = energy(p, run.state[before])
    assert run.contact_force[before].max() > press_force  # it did bounce on its spring
    assert before.sum() > 50
    # Local errors 1e-10 (1 + |state|), times momenta and forces of up to 20, over 100 steps.
    assert np.ptp(total) < 2e-7


@pytest.mark.parametrize("friction", [0.0, 0.12, 0.4])
@pytest.mark.parametrize("contact_damping", [0.0, 1.0, 10.0])
def test_a_run_without_excitation_only_loses_energy(device, friction, contact_damping):
    p = device.replace(**STILL, friction=friction, contact_damping=contact_damping)
    run = simulate(p, may_settle=False, horizon=20.0)
    end = run.tau_align if run.outcome is Outcome.ALIGNED else run.time[-1]
    total = energy(p, run.state[run.time < end])
    assert total[-1] < total[0] - 1e-3
    assert np.diff(total).max() < 1e-8  # as above, a step


# ------------------------------------------------------------------------------- static equilibrium


def test_pressed_part_comes_to_rest_in_static_equilibrium(device):
    # Without friction and excitation, strongly damped, and held by a stiff lateral spring.
    p = device.replace(
        **STILL, friction=0.0, lateral_stiffness=40.0, lateral_damping=10.0, axial_damping=4.0,
        tilt_stiffness=60.0, tilt_damping=40.0, contact_damping=10.0, initial_tilt=0.02,
    )  # fmt: skip
    run = simulate(p, may_settle=False, horizon=150.0)
    assert run.outcome is Outcome.HORIZON_REACHED

    def residual(pose):
        x, y, tilt = pose
        r = np.array([p.slot_half_width - x, -y])
        e_n = np.array([-sin(tilt), cos(tilt)])
        force = 100.0 * (p.half_height + r @ e_n) * e_n
        return [
            force[0] - p.lateral_stiffness * (x - p.misalignment),
            force[1] - (y - p.half_height) - p.press_force,
            r[0] * force[1] - r[1] * force[0] - p.tilt_stiffness * tilt,
        ]

    solution = root(residual, [p.misalignment, p.half_height, 0.05], tol=1e-13)
    assert solution.success
    assert run.state[-1, :3] == pytest.approx(solution.x, abs=1e-9)  # attracted, so not accumulated
    assert hypot(*run.state[-1, 3:5]) < 1e-9
    assert abs(run.state[-1, 5]) < 1e-9
    # The base carries the press force less what the axial spring holds.
    n = 100.0 * depth(p, run.state[-1:])[0]
    assert run.contact_force[-1] == pytest.approx(n, abs=1e-7)
    assert n * cos(solution.x[2]) == pytest.approx(
        p.press_force + solution.x[1] - p.half_height, abs=1e-7
    )


def test_constant_excitation_is_a_constant_force(device):
    # ν = 0 holds sin(phase): the run equals one pressed harder by just that.
    held = simulate(device.replace(frequency=0.0, phase=0.5), horizon=5.0)
    pressed = simulate(device.replace(**STILL, press_force=3.0 + sin(0.5)), horizon=5.0)
    assert held.outcome is pressed.outcome
    assert held.state[-1] == pytest.approx(pressed.state[-1], abs=1e-9)
