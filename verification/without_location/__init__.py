"""Runs without event location, as by an integrator that does not know the model's events."""

from verification.without_location.runs import (
    InitialValueProblem,
    Runs,
    Scheme,
    align,
    initial_value_problem,
)

__all__ = ["InitialValueProblem", "Runs", "Scheme", "align", "initial_value_problem"]
