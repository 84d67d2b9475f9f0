"""Runs without event location, as a code has them that does not know the events of the model."""

from verification.without_location.runs import (
    InitialValueProblem,
    Runs,
    Scheme,
    align,
    initial_value_problem,
)

__all__ = ["InitialValueProblem", "Runs", "Scheme", "align", "initial_value_problem"]
