"""Values as commands and sheets print them: in SI units with four digits, or dimensionless."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from model.physics.parameters import Parameters, Shape
from model.physics.quantities import (
    ACCELERATION,
    ANGLE,
    FORCE,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
    PLAIN,
    SPEED,
    STIFFNESS,
    TIME,
    Quantity,
)
from model.physics.units import Units
from vibralign.device import StatedDevice
from vibralign.device.holder import natural_frequencies
from vibralign.device.quantities import quantity_of

if TYPE_CHECKING:
    import xarray as xr

# Unit and its size in SI units: for values below 1, and for values from that size on.
_SMALL = {
    LENGTH: ("mm", 1e-3), TIME: ("ms", 1e-3), SPEED: ("mm/s", 1e-3), MASS: ("g", 1e-3),
    INERTIA: ("kg mm²", 1e-6),
}  # fmt: skip
_LARGE = {
    STIFFNESS: [("GN/m", 1e9), ("MN/m", 1e6), ("kN/m", 1e3)], FORCE: [("kN", 1e3)],
    ACCELERATION: [("g", 9.80665)],
}  # fmt: skip
_MICRO, _FINE = ("µm", 1e-6), 1e-4  # in drawings: of lengths that are all below 0.1 mm
_SHOWN = {each.unit: each for each in (LENGTH, TIME, SPEED, STIFFNESS, FORCE)}
_FAR = 30.0  # ratio of two values from which each is printed in its own unit
DIGITS = 4


def scale(units: Units | None, quantity: Quantity) -> float:
    """Return one dimensionless unit of a quantity in the units of the user."""
    return 1.0 if units is None else units.of(quantity)


def in_words(value: float, quantity: Quantity, units: Units | None, digits: int = DIGITS) -> str:
    """Return a dimensionless ``value`` in the units of the user, with its unit."""
    if units is None:
        return f"{value:.{digits}g}"
    return si_words(value * units.of(quantity), quantity, digits)


def range_words(
    low: float, high: float, quantity: Quantity, units: Units | None, digits: int = DIGITS
) -> str:
    """Return a dimensionless range in the units of the user, with one unit for both ends."""
    if units is None:
        return f"{low:.{digits}g} to {high:.{digits}g}"
    return si_list([value * units.of(quantity) for value in (low, high)], quantity, " to ", digits)


def rounded(value: float, digits: int = DIGITS) -> str:
    """Return a number with some digits, without an exponent where these are whole ones."""
    return f"{float(f'{value + 0.0:.{digits}g}'):.12g}"


def si_list(
    values: Sequence[float], quantity: Quantity, between: str = ", ", digits: int = DIGITS
) -> str:
    """Return values in SI units, in the unit of the largest; two far apart in their own units."""
    sizes = [abs(each) for each in values if each]
    units = {_printed_in(each, quantity) for each in sizes}
    if len(sizes) == len(units) == 2 and max(sizes) > _FAR * min(sizes):
        return between.join(si_words(each, quantity, digits) for each in values)
    unit, one = _printed_in(max(values, key=abs), quantity)
    return f"{between.join(rounded(value / one, digits) for value in values)} {unit}".rstrip()


def si_words(value: float, quantity: Quantity, digits: int = DIGITS) -> str:
    """Return a ``value`` in SI units with some digits and its unit; a tilt in degrees."""
    if math.isnan(value):
        return "none"
    unit, one = _printed_in(value, quantity)
    return f"{rounded(value / one, digits)} {unit}".rstrip()


def written_words(
    name: str, value: float, stated: StatedDevice | None = None, digits: int = DIGITS
) -> str:
    """Return a quantity of a device in the unit in which it is stated, else as ``si_words``."""
    unit, one = stated.written.get(name, ("", 1.0)) if stated else ("", 1.0)
    if not unit:
        return si_words(value, quantity_of(name)[1], digits)
    return f"{rounded(value / one, digits)} {unit}"


def named_words(values: Mapping[str, float], stated: StatedDevice | None = None) -> str:
    """Return quantities of a device by name, as ``written_words``: "press_force = 10 N"."""
    return ", ".join(f"{name} = {written_words(name, v, stated)}" for name, v in values.items())


def natural_record(parameters: Parameters, units: Units | None) -> dict[str, Any]:
    """Return the natural frequencies for --json, in the units of the user, and the excitation's."""
    one, natural = scale(units, FREQUENCY), natural_frequencies(parameters)
    return {
        "natural_frequencies": {name: value * one for name, value in natural.items()},
        "excitation_ratios": {
            name: parameters.frequency / value if value else None for name, value in natural.items()
        },
    }


def natural_words(parameters: Parameters, units: Units | None) -> str:
    """Return a line on the natural frequencies and how many times as fast the excitation is."""
    record = natural_record(parameters, units)
    natural = [
        f"{name} {in_words(value, FREQUENCY, units)}"
        for name, value in natural_frequencies(parameters).items()
    ]
    ratios = [
        "-" if each is None else f"{each:.3g}" for each in record["excitation_ratios"].values()
    ]
    words = f"; excitation at {', '.join(ratios)} times them"
    return f"natural frequencies: {', '.join(natural)}{words}"


def _printed_in(value: float, quantity: Quantity) -> tuple[str, float]:
    """Return ``display``, and degrees of a tilt."""
    return ("deg", math.pi / 180.0) if quantity == ANGLE else display(value, quantity)


def display(value: float, quantity: Quantity) -> tuple[str, float]:
    """Return the unit in which a value in SI units is shown, and its size in SI units."""
    size = abs(value)
    if quantity in _SMALL and 0.0 < size < 1.0:
        return _SMALL[quantity]
    for unit, one in _LARGE.get(quantity, ()):
        if size >= one:
            return unit, one
    return ("" if quantity == PLAIN else quantity.unit), 1.0


def readable(dataset: "xr.Dataset") -> "xr.Dataset":
    """Return a dataset in SI units with its numbers in the units in which they are read.

    Each variable is in the unit of its largest value, such as mm, ms or kN/m; lengths that are all
    below 0.1 mm are in µm. Variables in other units, and dimensionless ones, stay as they are.
    """
    changed = {}
    for name in map(str, dataset.variables):
        variable = dataset[name]
        quantity = _SHOWN.get(variable.attrs.get("units", ""))
        whole = dataset.get(name.removeprefix("start_"), variable)  # a coarser grid is like it
        sizes = np.abs(whole.values[np.isfinite(whole.values)]) if quantity else np.empty(0)
        if quantity is None or not sizes.size:
            continue
        most = float(sizes.max())
        unit, one = _MICRO if quantity == LENGTH and 0.0 < most < _FINE else display(most, quantity)
        attributes = variable.attrs | {"units": unit}
        changed[name] = (variable.dims, variable.values / one, attributes)
    coordinates = {name: each for name, each in changed.items() if name in dataset.coords}
    others = {name: each for name, each in changed.items() if name not in coordinates}
    return dataset.assign_coords(coordinates).assign(others)


def in_words_of(shape: Shape, words: str) -> str:
    """Return the paper's words, with a hole in place of the slot for a round part."""
    return words.replace("slot", "hole") if shape == "round" else words
