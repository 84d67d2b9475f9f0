"""Shares of the vibration, from made-up points."""

import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome, Unvibrated
from model.sweeps.vibration import BOTH, NEITHER, ONLY_PRESSED, ONLY_VIBRATED, added, overshoot_of

NAN = np.nan
A, S, L = Outcome.ALIGNED, Outcome.SETTLED, Outcome.LEFT_SCENE


@pytest.fixture
def points() -> xr.Dataset:
    """Four points that align, by vibration, by overshoot, by press and by toppling; two others."""
    columns = {
        "outcome": [A, A, A, A, S, S],
        "unvibrated": [
            Unvibrated.RESTS, Unvibrated.ALIGNS, Unvibrated.ALIGNS, Unvibrated.LEAVES,
            Unvibrated.ALIGNS, Unvibrated.RESTS,
        ],
        "slow_tilt": [0.1, 0.1, NAN, NAN, NAN, 0.2],
    }  # fmt: skip
    return xr.Dataset({name: ("f", np.array(values)) for name, values in columns.items()})


def test_overshoot_is_of_the_aligned_points(points):
    assert overshoot_of(points) == 0.25
    assert np.isnan(overshoot_of(points.isel(f=slice(4, None))))


def test_vibration_adds_one_of_four(points):
    expected = [ONLY_VIBRATED, BOTH, BOTH, ONLY_VIBRATED, ONLY_PRESSED, NEITHER]
    np.testing.assert_array_equal(added(points), expected)
