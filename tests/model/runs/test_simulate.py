"""Contents of a trajectory: states, forces, and summary."""

import numpy as np
import pytest

from model.physics.contacts import contact_load, edge_on_face, edge_on_side
from model.physics.geometry import bottom_corner, edge_place
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from vibralign import Outcome, align, simulate


@pytest.fixture(scope="module")
def run(device):
    return simulate(device)


def test_it_starts_at_rest_touching_the_edge(device, run, constants):
    assert run.time[0] == 0.0
    assert tuple(run.state[0, [0, 2, 3, 4, 5]]) == (
        device.misalignment,
        device.initial_tilt,
        0,
        0,
        0,
    )
    depth = edge_on_face(RIGHT_EDGE, State(*run.state[0]), constants(device)).depth
    assert depth == pytest.approx(0.0, abs=1e-14)


def test_time_never_goes_back_and_states_are_continuous(run):
    assert run.time.shape == (len(run.state),) == run.contact_force.shape == run.side_force.shape
    assert run.state.shape[1] == 6
    assert np.diff(run.time).min() >= 0.0
    same = np.diff(run.time) == 0.0
    # Where the same time occurs twice only a force may jump; a sticking contact is relieved of the
    # slip that rounding and the step's tolerance left in it.
    assert same.any()
    assert np.abs(np.diff(run.state, axis=0)[same]).max() < 1e-8
    assert np.isfinite(run.state).all()


def test_rates_are_the_derivatives_of_the_coordinates(run):
    # Trapezoids over the track: error h³/12 times a second derivative of a rate of up to 1e3 (the
    # contact at k_a = 100), h up to 0.02.
    h = np.diff(run.time)[:, None]
    moved = np.diff(run.state[:, :3], axis=0)
    trapezoid = 0.5 * h * (run.state[1:, 3:] + run.state[:-1, 3:])
    assert (np.abs(moved - trapezoid) <= 1e3 * h**3 / 12 + 1e-9).all()


def test_contact_force_is_the_base_s_law_at_the_state_and_zero_in_flight(device, run, constants):
    p = constants(device)
    pressing = 0
    before = run.time < run.tau_align
    for state, force in zip(run.state[before], run.contact_force[before], strict=True):
        q = State(*state)
        face = edge_on_face(RIGHT_EDGE, q, p)
        load = contact_load(face.depth, face.closing_rate, q, p)
        if force > 0.0:
            pressing += 1
            assert force == pytest.approx(load, abs=1e-9)
        else:  # in flight, or the base would have to pull
            assert face.depth < 1e-8 or load < 1e-6
    assert 0 < pressing < before.sum()


def test_side_force_is_the_base_s_law_on_the_side(device, constants):
    p = device.replace(frequency=0.5)
    run, c = simulate(p), constants(p)
    pressed = np.flatnonzero(run.side_force)
    assert len(pressed) > 20
    for i in pressed:
        q = State(*run.state[i])
        side = edge_on_side(LEFT_EDGE, q, c)
        load = contact_load(side.depth, side.closing_rate, q, c)
        assert run.side_force[i] == pytest.approx(load, abs=1e-9)
        along = edge_place(LEFT_EDGE, q.x, q.y, q.tilt, c).along_axis
        assert abs(along) <= c.half_height + 1e-9


def test_alignment_is_where_the_edge_passes_the_corner_with_the_other_in_the_slot(
    device, run, constants
):
    p = constants(device)
    assert run.outcome is Outcome.ALIGNED
    at = np.flatnonzero(run.time == run.tau_align)
    x, y, tilt = run.state[at[0], :3]
    assert run.tilt_at_alignment == tilt
    place = edge_place(RIGHT_EDGE, x, y, tilt, p)
    assert place.along_face == pytest.approx(p.half_width, abs=1e-9)
    left_x, left_y = bottom_corner(LEFT_EDGE, x, y, tilt, p)
    assert left_x >= -p.slot_half_width
    assert left_y < 0.0
    # Before, the edge was under the face. The contact force drops there.
    earlier = run.time < run.tau_align
    along = [edge_place(RIGHT_EDGE, *state[:3], p).along_face for state in run.state[earlier]]
    assert max(along) < p.half_width
    assert not run.contact_force[at[-1] :].any()


def test_corners_are_inside_a_little_later_and_the_track_ends_there(device, run, constants):
    p = constants(device)
    assert run.tau_align < run.tau_corners_inside == run.time[-1]
    (right_x, right_y), (left_x, left_y) = (
        bottom_corner(side, *run.state[-1, :3], p) for side in (RIGHT_EDGE, LEFT_EDGE)
    )
    slack = (p.slot_half_width - right_x, left_x + p.slot_half_width, -right_y, -left_y)
    assert min(slack) == pytest.approx(0.0, abs=1e-9)  # the last of the four just came to hold


def test_summary_agrees_with_the_track(run):
    before = run.time <= run.tau_align
    # The track holds four samples a step; peaks between them are a parabola higher.
    assert run.tilt_max == pytest.approx(np.abs(run.state[before, 2]).max(), abs=1e-4)
    assert run.contact_force_max == pytest.approx(run.contact_force.max(), rel=1e-2)
    assert run.contact_force_max >= run.contact_force.max()
    # Separations: falls of the force to zero that are not the last one.
    force = run.contact_force[run.time < run.tau_align]
    gone = np.flatnonzero((force[:-1] > 0.0) & (force[1:] == 0.0))
    assert run.separations == len(gone) == 7
    assert 0.0 < run.sticking_share < 1.0


def test_sticking_share_is_the_share_of_time_without_slip(device, run, constants):
    p = constants(device)
    slips = np.array([edge_on_face(RIGHT_EDGE, State(*state), p).slip for state in run.state])
    pressing = run.contact_force > 0.0
    sticks = (np.abs(slips) < 1e-9) & pressing
    h = np.diff(run.time)
    both = sticks[1:] & sticks[:-1] & (run.time[1:] <= run.tau_align)
    # The track is dense against a sticking phase, but its borders are samples.
    assert run.sticking_share == pytest.approx(h[both].sum() / run.tau_align, abs=0.02)


@pytest.mark.parametrize("frequency", [0.5, 1.0, 10.0])
def test_simulate_agrees_with_align(device, frequency):
    p = device.replace(frequency=frequency)
    one, many = simulate(p), align([p])
    assert one.tau_align == many.tau_align[0]
    assert one.outcome == many.outcome[0]
    assert one.rhs_evaluations == many.rhs_evaluations[0]
    assert one.tau_error == many.tau_error[0]
    for name in ("separations", "tilt_max", "sticking_share", "contact_force_max"):
        assert getattr(one, name) == getattr(many, name)[0]
