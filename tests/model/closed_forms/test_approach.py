"""The approach against closed forms: descent, ramp, first touch, rest, onset of the vibration."""

import numpy as np
import pytest

from model.engine.record import AT
from model.engine.results import RunResult
from model.events.scenes import Scene
from model.physics.parameters import constants_of
from model.physics.rest import rest_under_press
from model.runs.engine import engine_for, run_tracked
from vibralign import Batch, Outcome, Parameters, Reason, Settings, align, simulate

APPROACHES = {"slow": 0.05, "usual": 0.4, "faster than the vibration": 6.0}
NO_CONTACT = Scene("suspended", frozenset())


def swing(p: Parameters, time):
    """Return the complex swing of the steady descent, and its rate; at times after the start."""
    response = 1.0 - p.frequency**2 + 1j * p.axial_damping * p.frequency
    turning = np.exp(1j * (p.frequency * time + p.phase)) / response
    return turning.imag, (1j * p.frequency * turning).imag


@pytest.mark.parametrize("speed", APPROACHES.values(), ids=list(APPROACHES))
def test_the_part_comes_down_in_its_steady_descent(device, speed):
    p = device.replace(approach_speed=speed, phase=1.0, rest_tilt=0.01, axial_damping=0.3)
    run = simulate(p, start="running", tolerance=1e-12, horizon=1.0)
    before = run.time <= 0.0
    assert before.sum() >= 3
    time, (x, y, tilt) = run.time[before], run.state[before, :3].T
    own = time - time[0]
    shake, shake_rate = swing(p, own)
    line = y[0] + shake[0] - speed * own
    np.testing.assert_allclose(y, line - shake, atol=1e-10)
    np.testing.assert_allclose(run.state[before, 4], -speed - shake_rate, atol=1e-10)
    np.testing.assert_array_equal(x, p.misalignment)
    np.testing.assert_array_equal(tilt, p.rest_tilt)
    # It touches where the edge meets the bottom face, in the first contact of the run.
    reach = p.slot_half_width - p.misalignment
    height = (p.half_height - reach * np.sin(p.rest_tilt)) / np.cos(p.rest_tilt)
    at_touch = np.flatnonzero(run.time == 0.0)
    assert run.state[at_touch, 1] == pytest.approx(height, abs=1e-10)
    assert run.contact_force[before][:-1].max() == 0.0


@pytest.mark.parametrize("tilt", [-0.02, 0.0, 0.02])
def test_it_touches_with_the_lower_of_edge_and_corner(device, tilt):
    p = device.replace(approach_speed=0.4, rest_tilt=tilt)
    run = simulate(p, start="running", tolerance=1e-12, horizon=1.0)
    y, reach = run.state[np.flatnonzero(run.time == 0.0)[0], 1], p.slot_half_width - p.misalignment
    edge = (p.half_height - reach * np.sin(tilt)) / np.cos(tilt)
    corner = p.half_height * np.cos(tilt) - p.half_width * np.sin(tilt)
    assert y == pytest.approx(max(edge, corner), abs=1e-9)


def with_ramp(p: Parameters, settings: Settings, rate: float) -> RunResult:
    """Run from rest at the touch, without load, under a press that grows to f0 at a rate."""
    row = settings.rows(Batch.stack([p]))
    row[:, AT.press_rate], row[:, AT.ramp_end] = rate, p.press_force / rate
    return RunResult(*engine_for(settings)(row, np.array([settings.tolerance]))[0])


def test_a_fast_ramp_is_the_sudden_start_to_first_order(device):
    settings = Settings(tolerance=1e-12)
    sudden = simulate(device, settings).tau_align
    rates = np.array([500.0, 1000.0, 2000.0])
    late = np.array([with_ramp(device, settings, r).tau_align for r in rates]) - sudden
    assert (late > 0.0).all()
    assert late[1:] / late[:-1] == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("length", [1.0, 4.0, 2.0 * np.pi])
def test_a_ramp_overshoots_less_than_a_step(device, length):
    p = device.replace(frequency=0.0, axial_damping=0.0, press_force=2.0)
    settings = Settings(scene=NO_CONTACT, tolerance=1e-12, horizon=length + 10.0, may_settle=False)
    (row,) = settings.rows(Batch.stack([p]))
    row[AT.press_rate], row[AT.ramp_end] = p.press_force / length, length
    _, track = run_tracked(row, 1e-12, settings)
    time, y, y_rate = track[:, 0], track[:, 2], track[:, 5]
    after = time > length
    size = np.hypot(y - (p.half_height - p.press_force), y_rate)[after]
    step = p.press_force  # the amplitude about the new rest that a step leaves
    assert size == pytest.approx(step * abs(np.sin(length / 2) / (length / 2)), abs=1e-10)


def test_a_slow_press_without_vibration_comes_to_the_rest_of_a_slow_press(device):
    p = device.replace(press_force=0.8, rest_tilt=0.003, approach_speed=0.005, tilt_damping=3.0)
    rest = rest_under_press(constants_of(p, "square"))
    assert rest.found
    run = simulate(p, start="still", horizon=20.0)
    onset = np.flatnonzero(run.time <= 0.0)[-1]
    np.testing.assert_allclose(
        run.state[onset, :3], (rest.x, rest.y, rest.tilt), atol=2e-3 * np.abs(rest.tilt) + 2e-3
    )
    assert rest.tilt > 0.03


@pytest.mark.parametrize("start", ["running", "still"])
@pytest.mark.parametrize("shape", ["square", "round"])
def test_estimates_hold_where_a_part_is_lowered(device, start, shape):
    batch = Batch.of(
        device.replace(axial_damping=0.5, misalignment=0.3),
        approach_speed=np.geomspace(0.05, 5.0, 16),
        rest_tilt=np.linspace(-0.01, 0.01, 16),
        phase=np.linspace(0.0, 6.0, 16),
    )
    one, other = (align(batch, start=start, shape=shape, tolerance=each) for each in (1e-10, 1e-13))
    np.testing.assert_array_equal(one.outcome, other.outcome)
    np.testing.assert_array_equal(one.reason, other.reason)
    aligned = (one.outcome == Outcome.ALIGNED) & ~one.sensitive
    assert aligned.sum() >= 8
    error = (one.tau_error + other.tau_error)[aligned]
    assert (np.abs(one.tau_align - other.tau_align)[aligned] <= error).all()


def test_the_vibration_sets_in_at_its_phase(device):
    p = device.replace(approach_speed=0.4, press_force=0.8, axial_damping=0.5)
    one, other = (
        simulate(p.replace(phase=phase), start="still", horizon=40.0) for phase in (0.0, 2.0)
    )
    first, second = (np.flatnonzero(each.time <= 0.0)[-1] for each in (one, other))
    assert first == second
    np.testing.assert_array_equal(one.state[: first + 1], other.state[: first + 1])
    assert abs(one.state[-1] - other.state[-1]).max() > 1e-6


def test_a_part_that_the_press_alone_brings_in_says_so(device):
    p = device.replace(approach_speed=0.4, press_force=6.0, friction=0.02, axial_damping=1.0)
    run = simulate(p, start="still")
    assert (run.outcome, run.reason) == (Outcome.ALIGNED, Reason.BY_PRESS)
    assert "no vibration needed" in run.message


def test_a_part_that_never_comes_to_rest_says_so(device):
    p = device.replace(
        approach_speed=0.4, press_force=0.5, friction=0.9, tilt_stiffness=1e4, tilt_damping=0.0,
        axial_damping=0.0, lateral_damping=0.0, contact_damping=0.0,
    )  # fmt: skip
    run = simulate(p, start="still", horizon=50.0)
    assert (run.outcome, run.reason) == (Outcome.HORIZON_REACHED, Reason.STILL_MOVES)


def test_a_part_that_the_press_does_not_bring_down_says_so(device):
    run = simulate(device.replace(approach_speed=0.4, press_force=-3.0), start="running")
    assert (run.outcome, run.reason) == (Outcome.HORIZON_REACHED, Reason.NO_TOUCH)


def test_a_flat_part_and_one_on_its_corner_come_to_rest_too(device):
    p = device.replace(approach_speed=0.4, tilt_stiffness=300.0, rest_tilt=-0.02, axial_damping=1.0)
    run = simulate(p, start="still")
    assert run.reason is not Reason.STILL_MOVES
    assert run.state[run.time <= 0.0][-1, 2] < 0.0


def test_no_run_settles_while_the_holder_is_still_lowered(device):
    # The part hangs from a soft spring on the base: its motion repeats itself as the press grows.
    p = device.replace(
        approach_speed=0.004, press_force=2.0, friction=0.9, tilt_stiffness=1e4, rest_tilt=0.01
    )
    run = simulate(p, start="running", horizon=60.0, tolerance=1e-9)
    assert run.outcome is Outcome.SETTLED
    assert run.time[-1] > p.press_force / p.approach_speed - 300.0
    short = simulate(p, start="running", horizon=60.0, tolerance=1e-9, may_settle=False)
    assert short.time[-1] > run.time[-1]


@pytest.mark.parametrize(
    ("changes", "start", "words"),
    [
        ({"approach_speed": 1.0}, "simultaneous", "has no effect on the start"),
        ({}, "running", "approach_speed = None"),
        ({"approach_speed": 1.0, "frequency": 1.0, "axial_damping": 0.0}, "running", "resonance"),
    ],
)
def test_what_does_not_fit_the_start_is_refused(device, changes, start, words):
    with pytest.raises(ValueError, match=words):
        simulate(device.replace(**changes), start=start)
