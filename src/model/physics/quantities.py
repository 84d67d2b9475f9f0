"""Physical quantities: SI unit, and powers of the model's units of length, time and force."""

import math
from typing import NamedTuple


class Quantity(NamedTuple):
    """Physical quantity: its SI unit, and its powers of the model's three units.

    ``factor`` is a further factor from the model to SI: 1/(2π) for a frequency, which is angular in
    the model and in hertz in SI.
    """

    unit: str
    length: int = 0
    time: int = 0
    force: int = 0
    factor: float = 1.0


PLAIN = Quantity("1")
ANGLE = Quantity("rad")
LENGTH = Quantity("m", length=1)
TIME = Quantity("s", time=1)
MASS = Quantity("kg", length=-1, time=2, force=1)
FORCE = Quantity("N", force=1)
SPEED = Quantity("m/s", length=1, time=-1)
ACCELERATION = Quantity("m/s^2", length=1, time=-2)
TILT_RATE = Quantity("rad/s", time=-1)
FREQUENCY = Quantity("Hz", time=-1, factor=1.0 / (2.0 * math.pi))
INERTIA = Quantity("kg m²", length=1, time=2, force=1)
STIFFNESS = Quantity("N/m", length=-1, force=1)
DAMPING = Quantity("N s/m", length=-1, time=1, force=1)
TILT_STIFFNESS = Quantity("N m/rad", length=1, force=1)
TILT_DAMPING = Quantity("N m s/rad", length=1, time=1, force=1)
