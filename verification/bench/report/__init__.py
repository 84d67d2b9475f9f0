"""Section of the report on the comparison of methods, and its figures."""

from benchmarks.report import speed

SECTIONS = (speed.section,)
