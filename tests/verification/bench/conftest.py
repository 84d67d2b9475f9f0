"""Made-up errors and costs, as fixtures."""

from tests.comparison_data import timed_settings

__all__ = ["timed_settings"]
