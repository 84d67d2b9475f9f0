"""Ranges of what nobody has measured: everything within them is possible.

A device file states them below ``unknown:``. They stand apart from tolerances, which say what
varies from part to part, and from ``free``, which says what may still be chosen. A range is
uniform, or uniform in the logarithm where it spans a ``FACTOR`` and more.
"""

import math
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibralign.device.amounts import read_amount, read_range
from vibralign.device.instead import replaced_by
from vibralign.device.spelling import ends_of, plain

FACTOR = 4.0  # span from which on a range is uniform in the logarithm
MOST = 6  # unknown quantities
SECTION, SAMPLES = "unknown", "unknown_samples"


class Range(NamedTuple):
    """Range of an unknown quantity, in SI units."""

    low: float
    high: float

    @property
    def is_log(self) -> bool:
        """True if it is uniform in the logarithm."""
        return self.low > 0.0 and self.high >= FACTOR * self.low

    @property
    def middle(self) -> float:
        """Middle of the range, of its logarithm if it is uniform in that."""
        return float(self.at(np.array(0.5)))

    def at(self, shares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values at shares of the range, 0 to 1."""
        if self.is_log:
            return self.low * (self.high / self.low) ** shares
        return self.low + shares * (self.high - self.low)

    def share(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the shares of the range at which values are, as ``at`` takes them."""
        if self.is_log:
            return np.log(values / self.low) / math.log(self.high / self.low)
        return (values - self.low) / (self.high - self.low)


def read_unknown(
    given: Iterable[tuple[str, object]],
    stated: Collection[str],
    free: Collection[str],
    changes: Collection[str],
    unit_of: Any,
) -> tuple[dict[str, Range], dict[str, object]]:
    """Return the ranges of a file that ``changes`` leave, and their middles as a file states them.

    Raises:
        ValueError: no range, a quantity that is stated or free as well, or too many.
    """
    ranges, middles = dict[str, Range](), dict[str, object]()
    replaced = replaced_by(changes) | set(changes)
    for name, text in given:
        unit = unit_of(name)
        found = Range(*read_range(f"unknown: {name}", text, unit))
        if name == "phase":
            raise ValueError("unknown: phase: leave it out, since every phase is tried")
        if name in free:
            raise ValueError(f"{name}: stands below unknown and below free: leave one out")
        for other in sorted({name, *replaced_by([name])} & set(stated)):
            raise ValueError(f"{name}: is unknown, and {other} states it: leave one out")
        if name not in replaced:
            ranges[name], middles[name] = found, _written(name, str(text), found.middle, unit)
    if len(ranges) > MOST:
        raise ValueError(f"unknown: {len(ranges)} quantities: must be at most {MOST}")
    return ranges, middles


def _written(name: str, text: str, value: float, unit: str) -> object:
    """Return a value in the unit in which the end of a range is written."""
    own = ends_of(plain(text))[1].strip().lstrip("+-.0123456789eE").strip()
    try:
        one = read_amount(name, f"1 {own}", unit).value if own else 1.0
    except ValueError:  # an acceleration for an amplitude and the like
        return value
    return f"{value / one:.12g} {own}" if own else value


def refusal(source: Path, unknown: Collection[str], instead: str) -> ValueError:
    """Return the refusal of a device that is known in part, where single values are needed."""
    names = ", ".join(unknown)
    return ValueError(f"{source}: {names}: unknown, but single values are needed here: {instead}")
