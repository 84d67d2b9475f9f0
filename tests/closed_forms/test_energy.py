"""The work done on the part is what is stored and what is dissipated, in every run.

Work is done by excitation and press force. Stored is the energy of motion, springs and base,
½ k_a d² for a depth d behind a contact. Dissipated is what suspension, base and friction take: the
base h_a ḋ² while it presses, and while it is released, n = 0, what its spring gives up, -k_a d ḋ. A
contact that ends with the base still pushed in, as the edge leaves the face, loses that. Integrals
are Gauss's over each step of the engine, on its dense output.
"""

from math import sin

import numpy as np
import pytest

from model import Outcome
from model.physics.contacts import corner_on_flat, dot, edge_on_face, edge_on_side
from model.physics.motion import side_contact, support_contact
from model.physics.notation import State
from model.physics.scenes import CLOSED, OPEN, RELEASED

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
NODES, WEIGHTS = 0.5 * (NODES + 1.0), 0.5 * WEIGHTS


def contacts(q, p, mode):
    """(state, depth, closing rate) of every contact that is not open."""
    found = []
    if mode.face != OPEN:
        at = edge_on_face(mode.edge, q, p)
        found.append((mode.face, at.depth, at.closing_rate))
    if mode.corner != OPEN:
        at = corner_on_flat(mode.edge, q, p)
        found.append((mode.corner, at.depth - mode.corner_offset, at.closing_rate))
    if mode.side != OPEN:
        at = edge_on_side(q, p)
        found.append((mode.side, at.depth, at.closing_rate))
    return found


def stored(q, p, mode):
    motion = q.x_rate**2 + q.y_rate**2 + p.inertia * q.tilt_rate**2
    springs = p.lateral_stiffness * (q.x - p.rest_x) ** 2 + (q.y - p.rest_y) ** 2
    springs += p.tilt_stiffness * (q.tilt - p.rest_tilt) ** 2
    base = sum(p.contact_stiffness * depth**2 for _, depth, _ in contacts(q, p, mode))
    return 0.5 * (motion + springs + base)


def powers(run, time, q, mode):
    """(work of excitation and press force, dissipation) per time."""
    p, forces = run.p, run.forces(time, q, mode)
    work = -(p.press_force + sin(p.frequency * time + p.phase)) * q.y_rate
    lost = p.lateral_damping * q.x_rate**2 + p.axial_damping * q.y_rate**2
    lost += p.tilt_damping * q.tilt_rate**2
    for state, depth, closing in contacts(q, p, mode):
        if state == CLOSED:
            lost += p.contact_damping * closing**2
        elif state == RELEASED:
            lost -= p.contact_stiffness * depth * closing
    rates = q.x_rate, q.y_rate, q.tilt_rate
    lost -= forces.support_friction * dot(support_contact(q, p, mode).tangent, *rates)
    lost -= forces.side_friction * dot(side_contact(q, p, mode).tangent, *rates)
    return work, lost


def balance(run, tolerance):
    """(what is missing, largest of what was exchanged, dissipated) up to alignment or the end."""
    work = dissipated = lost = turned_over = 0.0
    for step in run.steps:
        if step.mode.dropped:
            break
        length = step.end - step.time
        for (time, q), weight in zip(run.places(step, NODES), WEIGHTS, strict=True):
            done, taken = powers(run, time, q, step.mode)
            assert (
                taken > -10 * tolerance
            )  # nothing gives energy but the excitation and the press force
            work += weight * length * done
            dissipated += weight * length * taken
            turned_over += weight * length * (abs(done) + abs(taken))
        end, last = State(*step.end_state), step
        released = stored(end, run.p, step.mode) - stored(end, run.p, step.end_mode)
        assert released > -10 * tolerance
        lost += released
    first = run.steps[0]
    gained = stored(State(*last.end_state), run.p, last.end_mode)
    gained -= stored(State(*first.state), run.p, first.mode)
    return work - gained - dissipated - lost, 1.0 + turned_over, dissipated


# What each motion is made of, and what differs from the device.
RUNS = {
    "slides and aligns": {"press_force": 2.0, "friction": 0.02, "frequency": 0.5},
    "sticks": {"press_force": 1.0, "friction": 0.25, "frequency": 0.5, "tilt_stiffness": 15.0},
    "hops": {"frequency": 10.0},
    "never aligns": {"tilt_stiffness": 5.0, "frequency": 10.0},
    "lands on its corner": {
        "press_force": 0.5, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.05,
    },
    "meets the side": {"frequency": 0.5},
    "on a hard base": {"contact_stiffness": 1e4, "contact_damping": 50.0, "frequency": 3.0},
    "with every damper": {
        "lateral_damping": 2.0, "axial_damping": 1.0, "tilt_damping": 8.0, "contact_damping": 5.0,
    },
    "without dampers": {
        "lateral_damping": 0.0, "axial_damping": 0.0, "tilt_damping": 0.0, "contact_damping": 0.0,
    },
}  # fmt: skip


@pytest.mark.parametrize("changes", RUNS.values(), ids=list(RUNS))
@pytest.mark.parametrize(("tolerance", "share"), [(1e-13, 1e-9), (1e-9, 1e-7), (1e-6, 1e-4)])
def test_energy_balances_to_the_tolerance(course, device, changes, tolerance, share):
    run = course(device.replace(**changes), horizon=6.0, tolerance=tolerance)
    missing, exchanged, dissipated = balance(run, tolerance)
    assert run.outcome in (Outcome.ALIGNED, Outcome.HORIZON_REACHED)
    assert dissipated > 0.01
    # At most some hundred tolerances for each of the two integrals; the dense output, of order 7,
    # leaves more than the steps do at the coarsest.
    assert abs(missing) < share * exchanged


def test_random_runs_balance(course, device):
    rng = np.random.default_rng(8)
    for _ in range(8):
        p = device.replace(
            press_force=rng.uniform(0.3, 6.0), frequency=10.0 ** rng.uniform(-0.5, 1.2),
            tilt_stiffness=rng.uniform(2.0, 60.0), friction=rng.uniform(0.0, 0.5),
            contact_stiffness=10.0 ** rng.uniform(1.5, 4.0), phase=rng.uniform(0.0, 6.0),
            contact_damping=rng.uniform(0.0, 5.0), half_height=rng.uniform(1.0, 5.0),
        )  # fmt: skip
        missing, exchanged, _ = balance(course(p, horizon=6.0, tolerance=1e-12), 1e-12)
        assert abs(missing) < 1e-9 * exchanged, p


def test_a_force_that_is_wrong_by_a_hundred_thousandth_is_seen(course, device):
    run = course(device, horizon=5.0, tolerance=1e-12)
    run.p = run.p._replace(lateral_damping=run.p.lateral_damping * (1.0 + 1e-5))
    missing, exchanged, _ = balance(run, 1e-12)
    assert abs(missing) > 1e-8 * exchanged
