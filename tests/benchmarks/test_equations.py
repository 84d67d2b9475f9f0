import numpy as np
import pytest

from benchmarks import modes
from benchmarks.equations import device
from benchmarks.trajectories import W1, W3
from model import Batch, Parameters, Variants
from model.compile.jit import kernel
from model.physics.modes import (
    CLOSED,
    OPEN,
    SLIP_NEGATIVE,
    SLIP_POSITIVE,
    STICKING,
    Mode,
)
from model.physics.modes import (
    RELEASED as CONTACT_RELEASED,
)
from model.physics.motion import motion
from model.physics.notation import State
from model.physics.parameters import Constants


def project_mode(face: int, slip: int) -> Mode:
    return Mode(1.0, face, OPEN, 0.0, False, slip, OPEN, STICKING, False)


SAME_MODE = {
    modes.OPEN: project_mode(OPEN, STICKING),
    modes.BEYOND: project_mode(OPEN, STICKING),
    modes.RELEASED: project_mode(CONTACT_RELEASED, STICKING),
    modes.SLIDE_POSITIVE: project_mode(CLOSED, SLIP_POSITIVE),
    modes.SLIDE_NEGATIVE: project_mode(CLOSED, SLIP_NEGATIVE),
    modes.STICK: project_mode(CLOSED, STICKING),
}


@kernel
def project_motion(time, q, p, mode):
    return motion(time, q, p, mode)


@pytest.mark.parametrize("case", [W1, W3], ids=["W1", "W3"])
@pytest.mark.parametrize("mode", modes.MODES)
def test_the_peers_motion_is_the_projects_in_every_mode(mode: int, case: Parameters) -> None:
    generator = np.random.default_rng(mode)
    p = np.array(device(case))
    constants = Constants(*Batch.stack([case]).constants(Variants())[0].tolist())
    rates, functions = np.empty(modes.STATE_SIZE), np.empty(modes.EVENT_COUNT)
    for _ in range(50):
        y = modes.start(case) + generator.normal(scale=0.1, size=modes.STATE_SIZE)
        time = generator.uniform(0.0, 10.0)
        modes.rates(time, y, p, mode, rates)
        modes.event_functions(time, y, p, mode, functions)
        expected = project_motion(time, State(*y.tolist()), constants, SAME_MODE[mode])
        size = 1.0 + np.abs(rates).max()
        assert np.array_equal(rates[:3], y[3:])
        # some ten sums and products of numbers of that size
        assert np.abs(rates[3:] - expected[:3]).max() <= 50 * np.finfo(float).eps * size
        if mode == modes.STICK:
            margin = case.friction * expected.support_load - abs(expected.support_friction)
            assert functions[modes.FRICTION] == pytest.approx(margin, rel=1e-12, abs=1e-12 * size)
        if mode in (modes.SLIDE_POSITIVE, modes.SLIDE_NEGATIVE):
            sign = 1.0 if mode == modes.SLIDE_POSITIVE else -1.0
            slip = sign * expected.support_slip
            assert functions[modes.FRICTION] == pytest.approx(slip, rel=1e-12, abs=1e-12)
            assert functions[modes.LOAD] == pytest.approx(expected.support_load, abs=1e-12 * size)
