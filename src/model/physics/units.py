"""SI units: the quantities of a device, against the dimensionless ones of the model.

The paper's sect. 2 measures lengths in the excitation's amplitude F1/K_Y, time in 1/p with
p² = K_Y/M, and forces in F1 = K_Y times the amplitude. Mass M, axial stiffness K_Y and amplitude of
a device are thus its three units; every other quantity is a product of their powers.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from model.physics.parameters import PARAMETER_NAMES, Parameters, check_name


class Quantity(NamedTuple):
    """What a quantity is measured in: its SI unit, and powers of the model's three units.

    ``factor`` SI units are one of the model where the three are one: 1/(2π) for a frequency, which
    is an angular one in the model and in hertz outside.
    """

    unit: str
    length: int = 0
    time: int = 0
    force: int = 0
    factor: float = 1.0


_PLAIN = Quantity("1")
_ANGLE = Quantity("rad")
_LENGTH = Quantity("m", length=1)
_STIFFNESS = Quantity("N/m", length=-1, force=1)
_DAMPING = Quantity("N s/m", length=-1, time=1, force=1)
_FORCE = Quantity("N", force=1)

QUANTITIES: Mapping[str, Quantity] = {
    "half_width": _LENGTH,
    "half_height": _LENGTH,
    "clearance": _PLAIN,
    "misalignment": _LENGTH,
    "initial_tilt": _ANGLE,
    "inertia": Quantity("kg m²", length=1, time=2, force=1),
    "lateral_stiffness": _STIFFNESS,
    "tilt_stiffness": Quantity("N m/rad", length=1, force=1),
    "lateral_damping": _DAMPING,
    "axial_damping": _DAMPING,
    "tilt_damping": Quantity("N m s/rad", length=1, time=1, force=1),
    "contact_stiffness": _STIFFNESS,
    "contact_damping": _DAMPING,
    "friction": _PLAIN,
    "press_force": _FORCE,
    "frequency": Quantity("Hz", time=-1, factor=1.0 / (2.0 * math.pi)),
    "phase": _ANGLE,
    "rest_x": _LENGTH,
    "rest_y": _LENGTH,
    "rest_tilt": _ANGLE,
}

DURATION = Quantity("s", time=1)

# The quantities that are the units of a device: meaning and SI unit.
UNITS: Mapping[str, tuple[str, str]] = {
    "mass": ("mass of the part and what moves with it", "kg"),
    "axial_stiffness": ("stiffness of the holder along the assembly axis", "N/m"),
    "amplitude": ("amplitude of the holder's excitation", "m"),
}
# What a device may leave open: the start, and the base as the paper models it (K_a, H_a).
_OPTIONAL = frozenset(
    {
        "initial_tilt", "contact_stiffness", "contact_damping", "phase", "rest_x", "rest_y",
        "rest_tilt",
    }
)  # fmt: skip


@dataclass(frozen=True)
class Units:
    """The three units of a device, each in SI and > 0.

    Attributes:
        mass: M, in kg.
        axial_stiffness: K_Y, in N/m.
        amplitude: F1/K_Y, in m.

    Raises:
        ValueError: a unit that is no finite number > 0.
    """

    mass: float
    axial_stiffness: float
    amplitude: float

    def __post_init__(self) -> None:
        for name in UNITS:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} = {value!r}: must be a finite number > 0")

    @property
    def time(self) -> float:
        """1/p = √(M/K_Y), in s."""
        return math.sqrt(self.mass / self.axial_stiffness)

    @property
    def force(self) -> float:
        """F1 = K_Y times the amplitude, in N."""
        return self.axial_stiffness * self.amplitude

    def of(self, quantity: Quantity) -> float:
        """One of the model's ``quantity`` in its SI unit."""
        powers = (self.amplitude, quantity.length), (self.time, quantity.time)
        scale = math.prod(unit**power for unit, power in (*powers, (self.force, quantity.force)))
        return scale * quantity.factor

    def in_si(self, parameters: Parameters) -> Parameters:
        """The model's ``parameters`` in the units of ``QUANTITIES``; what is derived stays so."""
        return Parameters(
            **{
                name: None if value is None else value * self.of(QUANTITIES[name])  # type: ignore[arg-type]
                for name, value in parameters.given().items()
            }
        )


class Device(NamedTuple):
    """A device measured in SI units, as the model takes it."""

    units: Units
    parameters: Parameters


def device(quantities: Mapping[str, float]) -> Device:
    """The device with these quantities, in the units of ``QUANTITIES``.

    The three of ``Units`` are needed, and all of ``FIELDS`` but the start's and the base's: what is
    left out of these is the model's own (K_a = 100 K_Y; the springs relaxed at the start).

    Raises:
        ValueError: a quantity unknown, missing or outside its rule, in its SI value.
    """
    for name in quantities:
        check_name(name, (*UNITS, *PARAMETER_NAMES), "quantity of a device")
    needed = (*UNITS, *(name for name in PARAMETER_NAMES if name not in _OPTIONAL))
    for name in needed:
        if name not in quantities:
            raise ValueError(f"{name} is missing: a device needs {', '.join(needed)}")
    units = Units(**{name: quantities[name] for name in UNITS})
    given = {name: value for name, value in quantities.items() if name not in UNITS}
    Parameters(**given)  # the rules hold in any units, so that a refusal names the values given
    return Device(
        units,
        Parameters(**{name: value / units.of(QUANTITIES[name]) for name, value in given.items()}),
    )
