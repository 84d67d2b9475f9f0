"""Made-up datasets, as fixtures."""

import pytest
import xarray as xr

from tests.vibralign.plots.drawn import DURATIONS, grid


@pytest.fixture
def family() -> xr.Dataset:
    return grid("curves", "tilt_stiffness", "press_force", DURATIONS.copy())
