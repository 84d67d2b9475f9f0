"""Made-up results of the comparison of methods, as fixtures."""

from tests.comparison_data import judged, timed_settings

__all__ = ["judged", "timed_settings"]
