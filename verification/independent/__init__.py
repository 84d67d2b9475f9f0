"""Independent solution of the alignment runs, for verification of the integrator."""

from verification.independent.solution import Solution, solve

__all__ = ["Solution", "solve"]
