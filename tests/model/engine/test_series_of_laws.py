"""Series of laws that the study's forces do not need, against closed forms."""

import numpy as np
import pytest

from model.compile.entries import address_of, compiled
from model.compile.kernels import kernel
from model.compile.vector_code import WIDTH, VectorFunction, call_at
from model.engine import workspace
from model.engine.mode_kinds import FREE, ON_RIGHT_EDGE, ModeKind
from model.engine.series import LANE_CONSTANTS, STATES, Sum, recurrences
from model.engine.series_code import SeriesWriter
from model.engine.series_layout import LINES, ORDER, Layout
from model.engine.workspace import COEFFICIENTS, LAST_ORDER, new_workspace


@compiled
@kernel
def fill_at(address, w):
    call_at(address, w, (COEFFICIENTS, 0, LAST_ORDER))


def test_a_law_may_multiply_positions():
    # ẍ = x³ with ẋ = x²/√2 is solved by x = √2/(c - τ): its coefficients are x_0 (x_0/√2)^k.
    found = recurrences(ModeKind(ON_RIGHT_EDGE, FREE, FREE))
    x = Sum(0.0, {STATES[0]: 1.0})
    cubic = found._replace(accelerations=(x * x * x, *found.accelerations[1:]))
    # Code is kept by its name, so that of another law has another.
    fill = VectorFunction("fill_cubic", lambda name: SeriesWriter(name, Layout(cubic)))
    w = new_workspace(workspace.EVENT_LINES)
    w[:LANE_CONSTANTS] = 1.0
    start = np.linspace(0.5, 1.5, WIDTH)
    w[COEFFICIENTS], w[COEFFICIENTS + 3] = start, start**2 / np.sqrt(2.0)
    w[LAST_ORDER] = ORDER
    fill_at(address_of(fill), w)
    orders = np.arange(ORDER + 1)
    expected = start * (start / np.sqrt(2.0)) ** orders[:, None]
    assert w[COEFFICIENTS + LINES * orders] == pytest.approx(expected, rel=1e-13)
