"""An independent solution of the alignment runs, to judge the integrator by."""

from verification.independent.solution import Solution, solve

__all__ = ["Solution", "solve"]
