"""Energy balance of every run: the work done on the part equals the energy stored and dissipated.

Excitation and press force do the work. Energy is stored in motion, in springs and in the base,
½ k_a d² at a contact of depth d. It is dissipated by suspension, friction and base: h_a ḋ² while
the base presses, and -k_a d ḋ, the energy that its spring gives up, while the contact is released
(n = 0). A contact that ends with the base still deformed, as the edge leaves the face, loses the
energy stored there. Integrals over a step are by Gauss's rule, on its series.
"""

from dataclasses import replace
from math import isnan
from typing import NamedTuple

import numpy as np
import pytest

from model.compile.entries import compiled
from model.compile.kernels import kernel
from model.engine import scheduling
from model.engine.event_search import state_at
from model.engine.lane_events import kind_of_mode
from model.engine.record import AT, STATE, constants_in, mode_of, state_in
from model.engine.series_kernels import missing_series
from model.engine.workspace import STEP_LENGTH
from model.events.outcomes import Reason
from model.events.transitions import CONTINUES
from model.physics.contacts import corner_on_flat, dot, edge_on_side, support_on_face
from model.physics.modes import CLOSED, RELEASED
from model.physics.motion import motion, side_contact, support_contact
from model.physics.notation import LEFT_EDGE
from model.physics.trigonometry import sine_cosine
from tests.model.engine.steps import OneRun
from verification.fuzz import draw
from vibralign import Batch, Outcome, Parameters, Settings, Variants

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
NODES, WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


class Balance(NamedTuple):
    """Energy balance up to alignment or the end of a run.

    ``missing`` is the error of the balance, ``exchanged`` its scale: the sum of work, dissipation
    and stored energy, plus 1. ``least`` is the lowest rate of dissipation.
    """

    missing: float
    exchanged: float
    dissipated: float
    least: float
    outcome: float
    reason: float


@kernel
def in_base(state, depth, closing, p):
    """(energy stored, power dissipated) in the base at one contact."""
    stored = 0.5 * p.contact_stiffness * depth * depth
    if state == CLOSED:
        return stored, p.contact_damping * closing * closing
    if state == RELEASED:
        return stored, -p.contact_stiffness * depth * closing
    return 0.0, 0.0


@kernel
def in_bases(q, p, mode):
    """(energy stored, power dissipated) in the base at all contacts."""
    face = support_on_face(mode.edge, q, p)
    corner = corner_on_flat(mode.edge, q, p)
    side = edge_on_side(LEFT_EDGE, q, p)
    a = in_base(mode.face, face.depth, face.closing_rate, p)
    b = in_base(mode.corner, corner.depth - mode.corner_offset, corner.closing_rate, p)
    c = in_base(mode.side, side.depth, side.closing_rate, p)
    return a[0] + b[0] + c[0], a[1] + b[1] + c[1]


@kernel
def stored(q, p, mode):
    moving = q.x_rate**2 + q.y_rate**2 + p.inertia * q.tilt_rate**2
    springs = p.lateral_stiffness * (q.x - p.rest_x) ** 2 + (q.y - p.rest_y) ** 2
    springs += p.tilt_stiffness * (q.tilt - p.rest_tilt) ** 2
    return 0.5 * (moving + springs) + in_bases(q, p, mode)[0]


@kernel
def powers(time, q, p, mode):
    """(power of excitation and press force, power dissipated)."""
    forces = motion(time, q, p, mode)
    excitation, _ = sine_cosine(p.frequency * time + p.phase)
    work = -(p.press_force + excitation) * q.y_rate
    lost = p.lateral_damping * q.x_rate**2 + p.axial_damping * q.y_rate**2
    lost += p.tilt_damping * q.tilt_rate**2 + in_bases(q, p, mode)[1]
    tangent, beside = support_contact(q, p, mode).tangent, side_contact(q, p, mode).tangent
    lost -= forces.support_friction * dot(tangent, q.x_rate, q.y_rate, q.tilt_rate)
    lost -= forces.side_friction * dot(beside, q.x_rate, q.y_rate, q.tilt_rate)
    return work, lost


@kernel
def weigh_step(scene, lanes, kind, control, memory, judged, nodes, weights, sums):
    w, runs = memory.w, memory.runs
    p, mode, time = constants_in(scene.events, judged), mode_of(runs, 0), runs[0, AT.time]
    memory.together[0] = 0
    scheduling.step_together(lanes, kind, 1, control, memory)
    scheduling.pass_step(scene, lanes, control, memory, 0, 0)
    whole, length = w[STEP_LENGTH, 0], runs[0, AT.time] - time
    for node in range(len(nodes)):
        theta, weight = nodes[node] * length, weights[node] * length
        q = state_at(theta / whole, w, 0)
        working, losing = powers(time + theta, q, p, mode)
        sums[0] += weight * working
        sums[1] += weight * losing
        sums[2] += weight * (abs(working) + abs(losing))
        sums[3] = min(sums[3], losing)
    q = state_in(runs, STATE, 0)
    sums[4] += stored(q, p, mode) - stored(q, p, mode_of(runs, 0))


@compiled
@kernel
def weigh(scene, lanes, control, memory, judged, nodes, weights, sums):
    """Make steps up to alignment or the end, and add their work, dissipation, loss and exchange.

    Return the number of a series that is to be loaded before the next step, or -1.
    """
    while memory.runs[0, AT.outcome] == CONTINUES and isnan(memory.runs[0, AT.tau_align]):
        kind = kind_of_mode(lanes, mode_of(memory.runs, 0))
        missing = missing_series(lanes, kind, False, memory.addresses)
        if missing >= 0:
            return missing
        weigh_step(scene, lanes, kind, control, memory, judged, nodes, weights, sums)
    return -1


@compiled
@kernel
def stored_in(scene, memory, judged):
    p, runs = constants_in(scene.events, judged), memory.runs
    return stored(state_in(runs, STATE, 0), p, mode_of(runs, 0))


def balance(
    parameters: Parameters, settings: Settings, judged: Parameters | None = None
) -> Balance:
    """Run ``parameters``, and balance the energy of every step with the device ``judged``."""
    row, judged_row = Batch.stack([parameters, judged or parameters]).constants(Variants())
    scene, control = settings.for_kernels
    p = scene.events.constants(*row.tolist())
    run = OneRun(p, settings.scene, tolerance=settings.tolerance, control=control)
    (record,), sums = run.memory.runs, np.zeros(5)
    start = stored_in(scene, run.memory, judged_row)
    given = scene, run.lanes, control, run.memory, judged_row, NODES, WEIGHTS, sums
    while (missing := weigh(*given)) >= 0:
        run.lanes.series.load(missing)
    gained = stored_in(scene, run.memory, judged_row) - start
    done, taken, exchanged, least, lost = sums.tolist()
    return Balance(
        done - gained - taken - lost, 1.0 + exchanged + 2.0 * start + gained, taken, least,
        record[AT.outcome], record[AT.reason],
    )  # fmt: skip


# What each motion is made of, and what differs from the device.
RUNS = {
    "slides and aligns": {"press_force": 2.0, "friction": 0.02, "frequency": 0.5},
    "sticks": {"press_force": 1.0, "friction": 0.25, "frequency": 0.5, "tilt_stiffness": 15.0},
    "lift-offs": {"frequency": 10.0},
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


OF_ROUND = {
    "tilts and creeps": {"frequency": 10.0, "friction": 0.05},
    "slides and aligns": {"press_force": 2.0, "friction": 0.02, "frequency": 0.5},
    "on a hard base": {"contact_stiffness": 1e4, "contact_damping": 50.0, "frequency": 3.0},
    "tilt passes zero": {"misalignment": 0.4, "frequency": 3.0, "initial_tilt": -0.02},
    "without dampers": RUNS["without dampers"],
}  # fmt: skip
CASES = [("square", changes) for changes in RUNS.values()]
CASES += [("round", changes) for changes in OF_ROUND.values()]
NAMES = [*RUNS, *(f"round: {name}" for name in OF_ROUND)]


@pytest.mark.parametrize(("shape", "changes"), CASES, ids=NAMES)
@pytest.mark.parametrize(("tolerance", "share"), [(1e-13, 1e-9), (1e-9, 1e-7), (1e-6, 1e-4)])
def test_energy_balances_to_the_tolerance(device, shape, changes, tolerance, share):
    settings = Settings(tolerance=tolerance, horizon=6.0, shape=shape)
    found = balance(device.replace(**changes), settings)
    assert Reason(int(found.reason)) is Reason.NONE
    assert found.dissipated > 0.01
    assert found.least > -10 * tolerance  # nothing gives energy but excitation and press force
    # At most some hundred tolerances for each of the two integrals.
    assert abs(found.missing) < share * found.exchanged


@pytest.mark.parametrize("misalignment", [0.1, 0.2, 0.35, 0.5])
def test_tips_keep_energy_without_damping_and_friction(device, misalignment):
    """The force of tips on the base has a potential; beyond 0.43 the part rocks on its rim, too."""
    kept = {"friction": 0.0, **RUNS["without dampers"], "misalignment": misalignment}
    settings = Settings(tolerance=1e-13, horizon=6.0, shape="round")
    found = balance(device.replace(tilt_stiffness=25.0, **kept), settings)
    assert found.dissipated == 0.0
    assert found.exchanged > 3.0
    assert abs(found.missing) < 1e-10 * found.exchanged


def test_a_force_that_is_wrong_by_a_hundred_thousandth_is_seen(device):
    wrong = device.replace(lateral_damping=device.lateral_damping * (1.0 + 1e-5))
    found = balance(device, Settings(tolerance=1e-12, horizon=5.0), judged=wrong)
    assert abs(found.missing) > 1e-8 * found.exchanged


def test_random_runs_of_every_outcome_balance(device):
    # The whole domain; and devices too soft to align, which have the time to settle.
    settings = Settings(tolerance=1e-13, horizon=3.0, max_evaluations=20_000)
    wild, rng = draw(11, 0, 200), np.random.default_rng(3)
    parts = [wild[row] for row in range(200)]
    found = [balance(each, settings) for each in parts]
    for _ in range(30):
        soft = device.replace(
            tilt_stiffness=rng.uniform(2.0, 6.0), press_force=rng.uniform(0.5, 4.0),
            frequency=10.0 ** rng.uniform(-0.3, 1.0), friction=rng.uniform(0.02, 0.3),
        )  # fmt: skip
        parts.append(soft)
        found.append(balance(soft, replace(settings, horizon=100.0, max_evaluations=10**6)))
    # What ran up to its alignment has not ended.
    outcomes = {Outcome(int(run.outcome)) if run.outcome >= 0.0 else None for run in found}
    in_slot = {Outcome.INSERTED, Outcome.JAMMED, Outcome.CLIMBED_OUT}
    assert outcomes == {None, *Outcome} - {Outcome.ALIGNED} - in_slot
    # A hundred tolerances, and what a state's rounding leaves unknown of the loads on a hard base,
    # by which the power is judged at some thousand places: at any tolerance of the run.
    for run, part in zip(found, parts, strict=True):
        load = np.finfo(float).eps * part.contact_stiffness * (part.half_width + part.half_height)
        assert abs(run.missing) < 1e-11 * run.exchanged + 0.1 * load


def test_stiff_runs_balance(device):
    rng = np.random.default_rng(2)
    for _ in range(10):
        p = device.replace(
            press_force=rng.uniform(1.0, 5.0), frequency=10.0 ** rng.uniform(-0.3, 1.0),
            tilt_stiffness=rng.uniform(5.0, 25.0), friction=rng.uniform(0.02, 0.2),
            contact_stiffness=10.0 ** rng.uniform(4.0, 8.0), contact_damping=1e4,
        )  # fmt: skip
        found = balance(p, Settings(tolerance=1e-12, horizon=4.0))
        assert abs(found.missing) < 1e-11 * found.exchanged
