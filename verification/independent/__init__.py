"""The independent solution: a second statement of the model on scipy, to verify the integrator."""

from verification.independent.insertion import insert
from verification.independent.printed import solve_printed
from verification.independent.round import solve_round
from verification.independent.solution import Solution, solve

__all__ = ["Solution", "insert", "solve", "solve_printed", "solve_round"]
