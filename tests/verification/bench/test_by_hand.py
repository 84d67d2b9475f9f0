"""Runs with fixed steps: evaluations, ends, convergence."""

from math import ceil, cos, isnan, sin

import numpy as np
import pytest

from model.compile.entries import compiled
from model.physics.contacts import contact_load, edge_on_face
from model.physics.notation import RIGHT_EDGE, State
from verification.bench.methods import by_hand
from verification.bench.methods.by_hand import solve_by_hand
from verification.bench.problems import Verdict
from vibralign import Batch, Settings, Variants, align

COST = {"rk4": 4, "semi_implicit_euler": 1}
schemes = pytest.mark.parametrize("scheme", COST)


def solved(case, scheme, step, **changes):
    return solve_by_hand(Batch.stack([case]), scheme, step, Settings(**changes))


rates_at, rk4_step, euler_step, outside_at = map(
    compiled, (by_hand.rates, by_hand.rk4_step, by_hand.euler_step, by_hand.outside)
)


@pytest.fixture(scope="module")
def slow(device):
    """A device that slides only, for about five time units."""
    return device.replace(friction=0.02, press_force=2.0, frequency=0.5, tilt_stiffness=15.0)


@schemes
def test_a_run_ends_with_the_step_in_which_the_part_fell(slow, scheme, constants):
    h = 0.01
    run = solved(slow, scheme, h)
    steps = ceil(run.tau_align[0] / h)
    assert run.evaluations == COST[scheme] * steps
    assert run.failure is None
    # The step before, it had not: the fall lies between, where a line crosses zero.
    earlier = solved(slow, scheme, h, horizon=(steps - 1) * h)
    assert isnan(earlier.tau_align[0])
    before, after = (
        outside_at(State(*each.states[0, 0]), constants(slow)) for each in (earlier, run)
    )
    assert before > 0.0 > after
    time = h * (steps - 1 + before / (before - after))
    assert run.tau_align[0] == pytest.approx(time, abs=1e-12)


@schemes
def test_a_part_that_has_fallen_in_at_the_start_takes_no_step(device, scheme):
    inside = device.replace(misalignment=0.01)
    run = solved(inside, scheme, 0.01)
    assert (run.tau_align[0], run.evaluations, run.failure) == (0.0, 0, None)


# Devices that meet each contact of the right-hand side. It infers how deep a corner was when it
# began to press: with landings the time converges to one that is 0.048 earlier.
CONTACTS = {
    "lift-offs": {"press_force": 1.1},
    "corner landings": {
        "press_force": 0.5, "frequency": 1.7, "tilt_stiffness": 46.0, "friction": 0.05,
    },
    "side contact": {"frequency": 0.5},
}  # fmt: skip


@schemes
@pytest.mark.parametrize("changes", CONTACTS.values(), ids=list(CONTACTS))
def test_they_converge_to_the_time_with_event_location(device, scheme, changes):
    """In truth by the located engine: a force that is wrong in any contact shows here."""
    own = device.replace(**changes)
    true = align([own], tolerance=1e-12).tau_align[0]
    errors = [abs(solved(own, scheme, h).tau_align[0] - true) for h in (2e-2, 1e-4)]
    # First order at best, of a motion whose velocities are of order 1.
    assert errors[1] < 0.05
    assert errors[1] < 0.1 * errors[0] or changes == CONTACTS["corner landings"]


@schemes
def test_a_run_ends_at_the_horizon_or_when_its_evaluations_are_spent(slow, scheme):
    at_horizon = solved(slow, scheme, 0.003, horizon=1.0)
    assert at_horizon.evaluations == COST[scheme] * 334  # the last step is shorter
    assert at_horizon.failure is None
    assert isnan(at_horizon.tau_align[0])
    spent = solved(slow, scheme, 1e-6, horizon=1.0, max_evaluations=50)
    assert spent.failure is Verdict.TOO_MANY_EVALUATIONS
    assert 40 <= spent.evaluations <= 50


def test_a_part_that_leaves_the_edge_or_turns_over_does_not_align(device):
    # From 160 on, Fig. 6's hard pressed parts turn over; the located run says so too.
    hard = device.replace(press_force=9.9, tilt_stiffness=5.0)
    run = solved(hard, "rk4", 1e-3)
    assert isnan(run.tau_align[0])
    assert run.failure is None
    assert run.evaluations < 4 * 300.0 / 1e-3


def test_a_batch_is_its_runs_one_by_one(device):
    batch = Batch.of(device, press_force=[1.0, 2.0, 3.0])
    together = solve_by_hand(batch, "rk4", 1e-3, Settings())
    alone = [solved(batch[row], "rk4", 1e-3) for row in range(len(batch))]
    assert together.tau_align.tolist() == [each.tau_align[0] for each in alone]
    assert together.evaluations == sum(each.evaluations for each in alone)
    np.testing.assert_array_equal(together.states, np.concatenate([each.states for each in alone]))


# ----------------------------------------------------------------------------------- order of steps


def pressed(along_face, depth, tilt, p):
    """(x, y) of the mass centre with A1 at s = ``along_face``, ``depth`` inside the face."""
    along_axis = depth - p.half_height
    c, s = cos(tilt), sin(tilt)
    r_x, r_y = along_face * c - along_axis * s, along_face * s + along_axis * c
    return p.slot_half_width - r_x, -r_y


HALVINGS = 6


def integrated(scheme, p, count):
    """The state at τ = 0.2 after ``count`` equal steps, sliding on A1 and pressed all the way."""
    q = State(*pressed(0.5, 0.05, 0.1, p), 0.1, -0.5, 0.0, 0.0)
    h = 0.2 / count
    for i in range(count):
        k1 = rates_at(i * h, q, p)
        q = rk4_step(i * h, h, q, k1, p) if scheme == "rk4" else euler_step(h, q, k1)
        contact = edge_on_face(RIGHT_EDGE, q, p)
        assert contact.slip < -0.1
        assert contact_load(contact.depth, contact.closing_rate, q, p) > 0.1
    return np.array(q)


@pytest.mark.parametrize(("scheme", "order"), [("rk4", 4), ("semi_implicit_euler", 1)])
def test_order_on_a_smooth_stretch(scheme, order, device, constants):
    p = constants(device)
    counts = [8 * 2**i for i in range(HALVINGS)]
    true = integrated("rk4", p, 2048)
    errors = [np.abs(integrated(scheme, p, count) - true).max() for count in counts]
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, rel=0.05)


def test_a_part_at_rest_has_no_friction(device, constants):
    q = State(*pressed(0.9, 0.05, 0.0, constants(device)), 0.0, 0.0, 0.0, 0.0)
    own, frictionless = (constants(each) for each in (device, device.replace(friction=0.0)))
    assert rates_at(0.0, q, own) == rates_at(0.0, q, frictionless)
    moving = q._replace(x_rate=1e-9)
    assert rates_at(0.0, moving, own).x_rate < rates_at(0.0, q, own).x_rate - 0.1


def test_a_part_past_the_edge_is_outside_as_printed_until_its_corners_are_in(device, constants):
    printed = Variants(alignment_criterion="printed")
    for readings, inside in ((Variants(), True), (printed, False)):
        p = constants(device, readings)
        q = State(*pressed(p.half_width + 1e-3, 0.02, 0.1, p), 0.1, 0.0, 0.0, 0.0)
        assert (outside_at(q, p) < 0.0) == inside
