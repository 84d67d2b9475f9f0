"""Results of the small study, made-up datasets, errors and costs, as fixtures."""

from tests.comparison_data import timed_settings
from tests.study.report_data import datasets, lines, rendered, root, study
from tests.vibralign.plots.conftest import family

__all__ = ["datasets", "family", "lines", "rendered", "root", "study", "timed_settings"]
