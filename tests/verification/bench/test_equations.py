import numpy as np
import pytest

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
from verification.bench import equations as peer
from verification.bench.equations import device
from verification.bench.trajectories import W1, W3
from vibralign import Batch, Parameters, Variants


def project_mode(face: int, slip: int) -> Mode:
    return Mode(1.0, face, OPEN, 0.0, False, slip, OPEN, STICKING, False)


SAME_MODE = {
    peer.OPEN: project_mode(OPEN, STICKING),
    peer.BEYOND: project_mode(OPEN, STICKING),
    peer.RELEASED: project_mode(CONTACT_RELEASED, STICKING),
    peer.SLIDE_POSITIVE: project_mode(CLOSED, SLIP_POSITIVE),
    peer.SLIDE_NEGATIVE: project_mode(CLOSED, SLIP_NEGATIVE),
    peer.STICK: project_mode(CLOSED, STICKING),
}


@pytest.mark.parametrize("case", [W1, W3], ids=["W1", "W3"])
@pytest.mark.parametrize("mode", list(peer.EVENTS))
def test_the_peers_motion_is_the_projects_in_every_mode(mode: int, case: Parameters) -> None:
    generator = np.random.default_rng(mode)
    p = np.array(device(case))
    constants = Constants(*Batch.stack([case]).constants(Variants())[0].tolist())
    rates_at = peer.rates_in(mode)
    functions_at = {which: peer.event_in(mode, which) for which in range(4)}
    for _ in range(50):
        y = peer.start(case) + generator.normal(scale=0.1, size=peer.STATE_SIZE)
        time = generator.uniform(0.0, 10.0)
        rates = rates_at(time, y, p)
        functions = {which: function(time, y, p) for which, function in functions_at.items()}
        expected = motion(time, State(*y.tolist()), constants, SAME_MODE[mode])
        size = 1.0 + np.abs(rates).max()
        assert np.array_equal(rates[:3], y[3:])
        # some ten sums and products of numbers of that size
        assert np.abs(rates[3:] - expected[:3]).max() <= 50 * np.finfo(float).eps * size
        if mode == peer.STICK:
            margin = case.friction * expected.support_load - abs(expected.support_friction)
            found = min(functions[peer.FRICTION], functions[peer.OTHER_FRICTION])
            assert found == pytest.approx(margin, rel=1e-12, abs=1e-12 * size)
        if mode in (peer.SLIDE_POSITIVE, peer.SLIDE_NEGATIVE):
            sign = 1.0 if mode == peer.SLIDE_POSITIVE else -1.0
            slip = sign * expected.support_slip
            assert functions[peer.FRICTION] == pytest.approx(slip, rel=1e-12, abs=1e-12)
            assert functions[peer.LOAD] == pytest.approx(expected.support_load, abs=1e-12 * size)
        for which in set(functions_at) - set(peer.EVENTS[mode]):
            assert functions[which] == 1.0, "is never met"
