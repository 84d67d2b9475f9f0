"""Sections of the report on the comparison of methods, and their figures."""

from benchmarks.report import hard_cases, speed

SECTIONS = (speed.section, hard_cases.section)
