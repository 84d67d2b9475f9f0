"""Independent solution of the runs, for verification of the integrator."""

from verification.independent.insertion import insert
from verification.independent.solution import Solution, solve

__all__ = ["Solution", "insert", "solve"]
