"""Made-up datasets, and results of the comparison of methods, as fixtures."""

import pytest
import xarray as xr

from tests.comparison_data import timed_settings
from tests.vibralign.plots.drawn import DURATIONS, grid

__all__ = ["timed_settings"]


@pytest.fixture
def family() -> xr.Dataset:
    return grid("curves", "tilt_stiffness", "press_force", DURATIONS.copy())
