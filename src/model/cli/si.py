"""Values as a command prints them: in SI units with four digits, or dimensionless."""

import math

from model.physics.quantities import (
    ANGLE,
    FORCE,
    LENGTH,
    PLAIN,
    STIFFNESS,
    TIME,
    Quantity,
)
from model.physics.units import Units

# Prefixes below the lower bound and from the upper one on: unit and its value in the SI unit.
_SMALL = {LENGTH: ("mm", 1e-3, 0.1), TIME: ("ms", 1e-3, 0.1)}
_LARGE = {STIFFNESS: [("MN/m", 1e6, 1e7), ("kN/m", 1e3, 1e4)], FORCE: [("kN", 1e3, 1e4)]}
DIGITS = 4


def scale(units: Units | None, quantity: Quantity) -> float:
    """Return one dimensionless ``quantity`` in the units of the user."""
    return 1.0 if units is None else units.of(quantity)


def in_words(value: float, quantity: Quantity, units: Units | None) -> str:
    """Return a dimensionless ``value`` in the units of the user, with its unit."""
    return si_words(value * scale(units, quantity), quantity) if units else f"{value:.{DIGITS}g}"


def si_words(value: float, quantity: Quantity) -> str:
    """Return a ``value`` in SI units with four digits and its unit, a tilt in degrees as well."""
    if math.isnan(value):
        return "none"
    unit, one = display(value, quantity)
    text = f"{value / one:.{DIGITS}g}" + (f" {unit}" if unit else "")
    return f"{text} ({math.degrees(value):.1f}°)" if quantity == ANGLE else text


def display(value: float, quantity: Quantity) -> tuple[str, float]:
    """Return the unit in which a value in SI units is shown, and its size in the SI unit."""
    size = abs(value)
    if quantity in _SMALL and 0.0 < size < _SMALL[quantity][2]:
        return _SMALL[quantity][:2]
    for unit, one, least in _LARGE.get(quantity, ()):
        if size >= least:
            return unit, one
    return ("" if quantity == PLAIN else quantity.unit), 1.0
