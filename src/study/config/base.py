"""Parts that sections of the configuration share: texts, values of parameters, ranges."""

import itertools
import os
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, model_validator

from model.sweeps.axes import Strict, check_rising, parameter_names


class ConfigError(ValueError):
    """Configuration that breaks rules; the message has a line for each fault."""


def _falling(values: list[float]) -> list[float]:
    falling = all(later < earlier for earlier, later in itertools.pairwise(values))
    if not (falling and values[-1] > 0.0):
        raise ValueError("must fall from one to the next and stay > 0")
    return values


def results_folder(value: object) -> str:
    """Return the path of a results root as it is, if it means one folder to every program.

    Raises:
        ValueError: it does not.
    """
    text = str(value) if isinstance(value, str) else ""
    plain = text == os.path.normpath(text) and text.isprintable()
    if (
        not plain
        or text.startswith("~")
        or set(text) & set("{}<>")
        or Path(text).name in ("", "..")
    ):
        raise ValueError(
            "must be the plain path of a folder, such as results-2 or /data/results: without a "
            "slash at its end, . or .. in it, ~ before it, braces, < or >, or a line break"
        )
    return text


ParameterValues = Annotated[dict[str, float], AfterValidator(parameter_names)]
ResultsFolder = Annotated[str, AfterValidator(results_folder)]
Text = Annotated[str, Field(min_length=1)]
Falling = Annotated[list[float], Field(min_length=1), AfterValidator(_falling)]


class LogRange(Strict):
    """A range of values > 0, uniform on a log axis."""

    low: float = Field(gt=0.0)
    """Smallest value, > 0."""
    high: float
    """Largest value, above ``low``."""

    @model_validator(mode="after")
    def _is_a_range(self) -> "LogRange":
        check_rising(("low", self.low), ("high", self.high))
        return self
