"""Axes of a grid, and plans: computations as data, checked before anything is computed."""

import hashlib
import itertools
from collections.abc import Callable
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from model.physics.parameters import PARAMETER_NAMES, check_name

Value = TypeVar("Value")


def parameter_name(name: str) -> str:
    """Return the name of a parameter.

    Raises:
        ValueError: there is no such parameter; the message names the nearest.
    """
    check_name(name, PARAMETER_NAMES, "parameter")
    return name


def parameter_names(values: dict[str, Value]) -> dict[str, Value]:
    """Return values by names of parameters."""
    for name in values:
        parameter_name(name)
    return values


def check_rising(low: tuple[str, float], high: tuple[str, float]) -> None:
    """Refuse two named values unless the first is smaller."""
    if not low[1] < high[1]:
        raise ValueError(f"{low[0]} = {low[1]} must be smaller than {high[0]} = {high[1]}")


class Strict(BaseModel):
    """A model that refuses unknown keys and values of another type."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


ParameterName = Annotated[str, AfterValidator(parameter_name)]
Tolerance = Annotated[float, Field(ge=1e-14, le=1e-2)]


class Axis(Strict):
    """Equidistant values of one parameter, both ends included."""

    parameter: ParameterName
    """Name of the parameter."""
    start: float
    """Lower end of the range."""
    stop: float
    """Upper end of the range, above ``start``."""
    count: int = Field(ge=2)
    """Number of values, both ends included."""

    @model_validator(mode="after")
    def _is_a_range(self) -> "Axis":
        check_rising(("start", self.start), ("stop", self.stop))
        return self

    @property
    def values(self) -> list[float]:
        """Values, rounded to 12 digits so that decimal steps read as decimals."""
        step = (self.stop - self.start) / (self.count - 1)
        return [float(f"{self.start + i * step:.12g}") for i in range(self.count)]


class Family(Strict):
    """Values of the parameter that differs between the curves of a figure."""

    parameter: ParameterName
    """Name of the parameter."""
    values: list[float] = Field(min_length=1)
    """Distinct values, one curve for each."""

    @model_validator(mode="after")
    def _is_distinct(self) -> "Family":
        if len(set(self.values)) < len(self.values):
            raise ValueError(f"values = {self.values} must differ from each other")
        return self


def check_plane(at: Callable[[dict[str, float]], object], x: Axis, y: Axis) -> None:
    """Refuse a map over one parameter twice, or a map whose corners break a rule.

    ``at`` raises a ValueError for values, by name, that break a rule.

    Raises:
        ValueError: naming the parameter, its value and its rule.
    """
    if x.parameter == y.parameter:
        raise ValueError(f"{x.parameter!r} is varied twice: x and y must be two parameters")
    for x_value, y_value in itertools.product((x.start, x.stop), (y.start, y.stop)):
        at({x.parameter: x_value, y.parameter: y_value})


class Plan(BaseModel):
    """A computation as data: everything that its results depend on besides the code.

    It holds numbers and no wording, so that a changed caption computes nothing anew.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    @property
    def identity(self) -> str:
        """Hash of the plan's JSON: equal for plans that give equal results."""
        return hashlib.sha256(self.model_dump_json(by_alias=True).encode()).hexdigest()[:16]


def points_of_chunk(count: int, chunk: int, chunks: int) -> NDArray[np.int64]:
    """Return the indices of every ``chunks``-th of ``count`` points, beginning with ``chunk``.

    So chunks cost alike.

    Raises:
        ValueError: ``chunk`` is not below ``chunks``.
    """
    if not 0 <= chunk < chunks:
        raise ValueError(f"chunk = {chunk}: must be 0 to {chunks - 1}")
    return np.arange(chunk, count, chunks, dtype=np.int64)
