"""The table of round pegs by the reference in three dimensions: outcomes, times, rows."""

import numpy as np
import pytest

from verification.round.motion import ALIGNED, RUNS_ON, Run
from verification.round.table import (
    COLUMNS,
    Truth,
    extrapolated,
    names_of,
    outcome_of,
    points,
    row_of,
)

HORIZON = 0.5


def run(speed, tilt=0.01, code=RUNS_ON):
    track = np.zeros((50, 9))
    track[:, 0] = np.linspace(0.0, HORIZON, 50)
    track[:, 1], track[:, 6] = speed * track[:, 0], tilt
    return Run(code, HORIZON, 1.0, 2.0, track)


@pytest.mark.parametrize(
    ("before", "last", "outcome"),
    [
        (run(-1e-3), run(-5e-4), "sticks"),  # creeps with the smoothing of friction
        (run(-1e-3, code=ALIGNED), run(-1e-3), "sticks"),
        (run(-1e-3), run(-9e-4), "creeps"),
        (run(-1e-3), run(-9e-4, tilt=0.0), "stands flat"),
    ],
)
def test_a_peg_sticks_where_its_creep_vanishes_with_the_smoothing(before, last, outcome):
    assert outcome_of(before, last, HORIZON) == outcome


def test_the_time_without_smoothing_is_extrapolated_and_the_base_leaves_it_open():
    # 10 - 2^-n at n = 1, 2, 3: the limit is 10
    assert extrapolated((9.5, 9.75, 9.875, 9.75, 9.75)) == pytest.approx((10.0, 0.125))
    # 1/k: 9.75 is 10 - 0.25, so 9 at k/4
    assert extrapolated((9.75, 9.75, 9.75, 9.0, 9.9375))[1] == pytest.approx(0.25)
    assert extrapolated((9.75, 9.75, 9.75, 9.75, 10.5))[1] == pytest.approx(1.0)


def test_a_row_has_all_columns():
    q = points("truth")[3]
    truth = Truth("aligns", 1.0, 0.1, 2.0, 3.0, 0.2, (1.0,) * 5)
    row = row_of(q, truth)
    assert len(row) == len(COLUMNS) + len(names_of(q))
    assert row[len(COLUMNS) + names_of(q).index("amplitude")] == "0.003"
