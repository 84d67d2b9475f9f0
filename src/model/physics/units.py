"""Conversion between the SI quantities of a device and the dimensionless parameters of the model.

The paper's sect. 2 measures lengths in the excitation's amplitude F1/K_Y, time in 1/p with
p² = K_Y/M, and forces in F1 = K_Y times the amplitude. Mass M, axial stiffness K_Y and amplitude of
a device are thus its three units; every other unit is a product of their powers.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.physics.fields import Field
from model.physics.parameters import FIELDS, PARAMETER_NAMES, REQUIRED_NAMES, Parameters, check_name
from model.physics.quantities import LENGTH, MASS, STIFFNESS, Quantity

# The quantities that serve as units of a device.
UNITS: Mapping[str, Field] = {
    "mass": Field("M", "mass of the part and what moves with it", MASS, "> 0"),
    "axial_stiffness": Field(
        "K_Y", "stiffness of the holder along the assembly axis", STIFFNESS, "> 0"
    ),
    "amplitude": Field("A", "amplitude (peak) of the holder's excitation", LENGTH, "> 0"),
}

# The quantities that a device must state.
NEEDED = (*UNITS, *(n for n in FIELDS if n in REQUIRED_NAMES or FIELDS[n].measured))


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
        """Return one dimensionless unit of ``quantity`` in its SI unit."""
        return float(_scale(self.amplitude, self.time, self.force, quantity))

    def in_si(self, parameters: Parameters) -> Parameters:
        """Convert the model's ``parameters`` to SI units; ``None`` stays ``None``."""
        return Parameters(
            **{
                name: None if value is None else value * self.of(FIELDS[name].quantity)  # type: ignore[arg-type]
                for name, value in parameters.given().items()
            }
        )


def _scale(amplitude: Any, time: Any, force: Any, quantity: Quantity) -> Any:
    """Return a dimensionless unit of ``quantity`` in SI units, of numbers or of arrays."""
    powers = (amplitude, quantity.length), (time, quantity.time), (force, quantity.force)
    return math.prod(unit**power for unit, power in powers) * quantity.factor


def scales(units: Sequence[Units], quantity: Quantity) -> NDArray[np.float64]:
    """Return ``of`` of each of ``units``, shape (n,), fast where many are one and the same."""
    places = {id(each): place for place, each in enumerate(units)}
    distinct = {own: row for row, own in enumerate(places)}
    one = [units[place] for place in places.values()]
    lengths, times, forces = (
        np.array([getattr(each, name) for each in one]) for name in ("amplitude", "time", "force")
    )
    found: NDArray[np.float64] = _scale(lengths, times, forces, quantity) * np.ones(len(one))
    return found[[distinct[id(each)] for each in units]]


class Device(NamedTuple):
    """Device: its three units in SI, and its dimensionless parameters."""

    units: Units
    parameters: Parameters


def device(quantities: Mapping[str, float]) -> Device:
    """Return the device with these ``quantities``, in SI units.

    Required are the three of ``UNITS``, the parameters without a default, and those that must be
    ``measured``. All others have the model's defaults (K_a = 100 K_Y; the springs relaxed at the
    start).

    Raises:
        ValueError: a quantity unknown, missing or outside its rule, in its SI value.
    """
    for name in quantities:
        check_name(name, (*UNITS, *PARAMETER_NAMES), "quantity of a device")
    for name in NEEDED:
        if name not in quantities:
            raise ValueError(f"{name} is missing: a device needs {', '.join(NEEDED)}")
    units = Units(**{name: quantities[name] for name in UNITS})
    given = {name: value for name, value in quantities.items() if name not in UNITS}
    Parameters(**given)  # the rules hold in any units: a refusal here names the value in SI
    return Device(
        units,
        Parameters(
            **{name: value / units.of(FIELDS[name].quantity) for name, value in given.items()}
        ),
    )
