"""The carried error at an event: equal to the displacement of a run from a displaced start."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from model.compile.entries import compiled
from model.engine.carried_error import apply_saltation, error_of_time
from model.engine.rates import rates_at
from model.engine.record import AT, ERROR, MODE, SIZE
from model.events import kernels
from model.events.friction import hold_sticking
from model.events.kernels import events_of
from model.events.scenes import ALIGNMENT
from model.events.table import number_of
from model.physics.modes import CLOSED, OPEN, RELEASED, START, STICKING
from model.physics.notation import State
from model.physics.parameters import Batch, Constants
from model.physics.variants import Variants

EVENTS = events_of(ALIGNMENT.events)
level_at, rates_of = compiled(kernels.level), compiled(rates_at)
NOW = 0.7
ON_FACE = START._replace(face=CLOSED, support_slip=-1, side_slip=-1)


def flow(state, since, until, p, mode):
    """The state at ``until`` in a mode that does not change."""

    def rates(time, y):
        return np.array(rates_of(time, State(*y), p, mode))

    found = solve_ivp(rates, (since, until), state, method="DOP853", rtol=1e-12, atol=1e-14)
    return found.y[:, -1]


@pytest.fixture
def p(device):
    return Constants(*Batch.stack([device]).constants(Variants.consistent())[0])


@pytest.mark.parametrize(
    ("event", "before", "after"),
    [
        ("support_slip", ON_FACE, ON_FACE._replace(support_slip=1)),
        ("support_slip", ON_FACE, ON_FACE._replace(support_slip=STICKING)),
        ("face_load", ON_FACE, ON_FACE._replace(face=RELEASED)),
        ("face_gap", ON_FACE._replace(face=RELEASED), ON_FACE._replace(face=OPEN)),
    ],
    ids=["reverses", "sticks", "loses its load", "opens a gap"],
)
def test_an_error_passes_an_event_as_a_displaced_run_does(event, before, after, p):
    which = number_of(event)

    def level(later, state):
        moved = flow(state, NOW, NOW + later, p, before)
        return level_at(EVENTS, which, NOW + later, State(*moved), p, before)

    def time_of(state):
        return brentq(level, -1e-4, 1e-4, args=(state,), xtol=1e-15)

    rng = np.random.default_rng(5)
    start = np.array([p.misalignment, p.rest_y - 0.02, 0.05, 0.1, -0.1, 0.2])
    if event == "support_slip":  # at rest, and about to slip back
        start = np.array(hold_sticking(State(*start), p, before._replace(support_slip=STICKING)))
    else:  # moving up, at a height without load
        start[4] = 0.5
        heights = np.linspace(-0.1, 0.1, 3)
        start[1] += brentq(lambda dy: level(0.0, start + [0, dy, 0, 0, 0, 0]), *heights[[0, -1]])
    error = 1e-6 * rng.uniform(-1.0, 1.0, 6)
    late = time_of(start + error)
    at_event = flow(start + error, NOW, NOW + late, p, before)
    at_event = np.array(hold_sticking(State(*at_event), p, after))
    expected = flow(at_event, NOW + late, NOW, p, after) - start

    runs = np.zeros((1, SIZE))
    runs[0, : len(p)], runs[0, AT.time], runs[0, ERROR : ERROR + 6] = p, NOW, error
    runs[0, MODE : MODE + len(after)] = after
    runs[0, AT.largest_error] = np.abs(error).max()  # as the step before the event noted it
    bound = error_of_time(EVENTS, which, State(*start), before, runs, 0)
    alone = [
        brentq(level, -1e-4, 1e-4, args=(start + each,), xtol=1e-15) for each in np.diag(error)
    ]
    assert bound == pytest.approx(np.abs(alone).sum(), rel=1e-3)
    assert bound >= abs(late) * (1.0 - 1e-3)
    rates = rates_of(NOW, State(*start), p, before)
    apply_saltation(EVENTS, which, State(*start), rates, before, runs, 0)
    found = runs[0, ERROR : ERROR + 6]
    np.testing.assert_allclose(found, expected, atol=2e-4 * np.abs(expected).max())
    # Accelerations jump where a slip changes, and are continuous where a load vanishes.
    jumps = np.abs(found - error).max() > 1e-3 * np.abs(error).max()
    assert jumps == (event == "support_slip")
    assert runs[0, AT.largest_error] == max(np.abs(error).max(), np.abs(found).max())
