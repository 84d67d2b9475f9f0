"""Series of laws that the study's forces do not need, against closed forms."""

import numpy as np
import pytest

from model.compile.vector_code import WIDTH
from model.engines.batch import series_kernels, workspace
from model.engines.batch.mode_kinds import FREE, ON_RIGHT_EDGE, ModeKind
from model.engines.batch.series import GIVEN, STATES, Sum, recurrences
from model.engines.batch.series_layout import ORDER, LINES
from model.engines.batch.workspace import COEFFICIENTS, LAST_ORDER, new_workspace


def test_a_law_may_multiply_positions(monkeypatch):
    # ẍ = x³ with ẋ = x²/√2 is solved by x = √2/(c - τ): its coefficients are x_0 (x_0/√2)^k.
    def cubic(kind, inserts):
        x, found = Sum(0.0, {STATES[0]: 1.0}), recurrences(kind, inserts)
        return found._replace(accelerations=(x * x * x, *found.accelerations[1:]))

    monkeypatch.setattr(series_kernels, "recurrences", cubic)
    # Finished code is kept by its name, so that of another law has another.
    kinds = [ModeKind(ON_RIGHT_EDGE, FREE, FREE)]
    fill = series_kernels.filler("fill_cubic", series_kernels.SeriesWriter, kinds, False)
    flat = new_workspace(workspace.EVENT_LINES)
    w = flat.reshape(-1, WIDTH)
    w[: GIVEN - 2] = 1.0
    start = np.linspace(0.5, 1.5, WIDTH)
    w[COEFFICIENTS], w[COEFFICIENTS + 3] = start, start**2 / np.sqrt(2.0)
    w[LAST_ORDER] = ORDER
    fill(0, flat, COEFFICIENTS, 0, LAST_ORDER)
    orders = np.arange(ORDER + 1)
    expected = start * (start / np.sqrt(2.0)) ** orders[:, None]
    assert w[COEFFICIENTS + LINES * orders] == pytest.approx(expected, rel=1e-13)
