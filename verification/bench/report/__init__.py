"""Section of the report on the comparison of methods, and its figures."""

from verification.bench.report import speed

SECTIONS = (speed.section,)
