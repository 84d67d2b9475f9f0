"""Limits that a device file states: of forces, times and tilts, and of the vibrator."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from model.physics.parameters import check_name
from model.physics.quantities import ACCELERATION, ANGLE, FORCE, LENGTH, TIME, Quantity
from vibralign.device.amounts import read_positive

# Upper limits that a design may have to keep: meaning and quantity.
LIMITS: Mapping[str, tuple[str, Quantity]] = {
    "contact_force": ("largest contact force", FORCE),
    "time": ("longest time until alignment, not until insertion", TIME),
    "tilt": ("largest tilt until alignment", ANGLE),
    "acceleration": ("largest acceleration of the vibrator", ACCELERATION),
    "stroke": ("largest stroke of the vibrator, from end to end", LENGTH),
}
# Limit "vibration" of a design: the share of devices that must not align without vibration.
VIBRATION: Mapping[str, float] = {"needed": 1.0, "not needed": 0.0}
OF_VIBRATOR = ("acceleration", "stroke")


def read_limits(given: Iterable[tuple[str, object]]) -> dict[str, float]:
    """Return the limits of a file by name, in SI units; of "vibration" the share.

    Raises:
        ValueError: an unknown limit, one that is no amount > 0, or has a tolerance.
    """
    limits = dict[str, float]()
    for name, value in given:
        check_name(name, (*LIMITS, "vibration"), "limit of a design")
        if name == "vibration":
            if str(value) not in VIBRATION:
                words = " or ".join(VIBRATION)
                raise ValueError(f"limits: vibration = {value!r}: must be {words}")
            limits[name] = VIBRATION[str(value)]
            continue
        words, quantity = LIMITS[name]
        limits[name] = read_positive(f"limits: {name}", value, quantity.unit, f"the {words}")
    return limits


def of_vibrator(amplitude: Any, frequency: Any) -> dict[str, Any]:
    """Return what a vibration (peak in m, Hz) needs of the vibrator, by ``OF_VIBRATOR``."""
    return {"acceleration": amplitude * (math.tau * frequency) ** 2, "stroke": 2.0 * amplitude}
