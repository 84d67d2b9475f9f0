"""Results of the small study, and of the comparison of methods, as fixtures."""

from tests.comparison_data import timed_settings
from tests.study.report_data import datasets, lines, rendered, root, study

__all__ = ["datasets", "lines", "rendered", "root", "study", "timed_settings"]
