"""Section of the report on error against cost."""

from verification.bench.report import speed

SECTIONS = (speed.section,)
