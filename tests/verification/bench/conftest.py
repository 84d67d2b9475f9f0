"""Made-up results of the comparison of methods, as fixtures."""

from tests.comparison_data import timed_settings

__all__ = ["timed_settings"]
