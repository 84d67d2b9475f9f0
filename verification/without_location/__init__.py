"""Runs without event location, as by an integrator that does not know the model's events."""

from verification.without_location.engine import LANES
from verification.without_location.runs import (
    InitialValueProblem,
    Runs,
    Scheme,
    align,
    initial_value_problem,
)

__all__ = ["LANES", "InitialValueProblem", "Runs", "Scheme", "align", "initial_value_problem"]
