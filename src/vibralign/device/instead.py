"""Quantities of data sheets in place of parameters: diameter, length, play, natural frequencies.

The holder with its part is three oscillators (holder.py), each of which has the natural frequency
f = √(k/m) / 2π and, at the damping ratio ζ, the damping h = 2ζ √(k m); in tilt with k_φ and I_φ.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from model.physics.fields import Bound
from model.physics.quantities import FREQUENCY, LENGTH, PLAIN, Quantity
from vibralign.device.base import SOURCES as OF_BASE
from vibralign.device.holder import DIRECTIONS, mass_and_stiffness


class Instead(NamedTuple):
    """A quantity that a device file may state in place of a parameter.

    Attributes:
        parameter: name of the parameter.
        description: meaning in a few words.
        quantity: physical quantity.
        needs: further quantities from which the parameter is computed.
        value: the parameter from the quantity and these, in SI units; numbers or arrays.
        bound: admissible range.
    """

    parameter: str
    description: str
    quantity: Quantity
    needs: tuple[str, ...]
    value: Callable[..., float]
    bound: Bound = "> 0"


def _half(whole: float) -> float:
    return 0.5 * whole


def _clearance(play: float, half_width: float) -> float:
    return play / (2.0 * half_width)


def _stiffness(frequency: float, mass: float) -> float:
    return mass * (math.tau * frequency) ** 2


def _damping(ratio: float, mass: float, stiffness: float) -> float:
    return ratio * (2.0 * (stiffness * mass) ** 0.5)


# In the order in which they are computed: a damping needs the stiffness.
INSTEAD: Mapping[str, Instead] = {
    "diameter": Instead("half_width", "diameter, or width of a square part", LENGTH, (), _half),
    "length": Instead("half_height", "length of the part", LENGTH, (), _half),
    "centre_height": Instead(
        "half_height", "height of the mass centre over the bottom face", LENGTH, (), float
    ),
    "play": Instead(
        "clearance", "diameter of the hole minus the part's", LENGTH, ("half_width",), _clearance
    ),
    **{
        f"{each}_frequency": Instead(
            f"{each}_stiffness", f"natural frequency of the holder, {each}", FREQUENCY,
            mass_and_stiffness(each)[:1], _stiffness,
        )
        for each in DIRECTIONS
    },
    **{
        f"{each}_damping_ratio": Instead(
            f"{each}_damping", "damping ratio", PLAIN, mass_and_stiffness(each), _damping, ">= 0"
        )
        for each in DIRECTIONS
    },
}  # fmt: skip
# Parameters, and the quantities of a device file from which they are computed if stated.
SOURCES: Mapping[str, tuple[str, ...]] = {
    **OF_BASE,
    **{
        name: tuple(each for each, other in INSTEAD.items() if other.parameter == name)
        for name in dict.fromkeys(each.parameter for each in INSTEAD.values())
    },
}


_TWO_CENTRES = (
    "length and centre_height both place the mass centre, length in the middle of the part: leave "
    "length out"
)


def name_in(quantities: Iterable[str], parameter: str) -> str:
    """Return by which name a file with these quantities states a parameter."""
    stated = [name for name, each in INSTEAD.items() if each.parameter == parameter]
    return next((name for name in stated if name in quantities), parameter)


def parameter_of(name: str) -> str:
    """Return the parameter that a quantity is, or is stated in place of."""
    return INSTEAD[name].parameter if name in INSTEAD else name


def with_parameters(quantities: Mapping[str, float]) -> dict[str, float]:
    """Return quantities in SI units, with parameters in place of those of ``INSTEAD``.

    Raises:
        ValueError: a quantity outside its rule, one without another that it needs, or two that
            state the same.
    """
    found, stated = dict[str, float](), dict[str, str]()
    for name, value in quantities.items():
        if name in INSTEAD:
            bound, parameter = INSTEAD[name].bound, INSTEAD[name].parameter
            if not 0.0 <= value < math.inf or (value == 0.0 and bound == "> 0"):
                raise ValueError(f"{name} = {value!r}: must be a finite number {bound}")
            twin = stated.get(parameter, parameter if parameter in quantities else "")
            if {twin, name} == {"length", "centre_height"}:
                raise ValueError(_TWO_CENTRES)
            if twin:
                raise ValueError(f"{twin} and {name} state the same: leave one out")
            stated[parameter] = name
        else:
            found[name] = value
    for name, each in INSTEAD.items():
        if stated.get(each.parameter) == name:
            for need in each.needs:
                if not found.get(need, -1.0) >= 0.0:
                    size = {} if stated.get("half_height") == "centre_height" else found
                    raise ValueError(f"{name} needs {need}, a number > 0{_hint(need, size)}")
            found[each.parameter] = each.value(quantities[name], *(found[n] for n in each.needs))
    return found


def _hint(name: str, found: Mapping[str, float]) -> str:
    """Return how to get an inertia: by formulas, and in numbers if mass and size are stated."""
    if name != "inertia":
        return ""
    words = "; about the mass centre, a cylinder has m (3 r² + h²) / 12, a block m (w² + h²) / 12"
    if {"mass", "half_width", "half_height"} <= found.keys():
        mass, half, height = (found[n] for n in ("mass", "half_width", "half_height"))
        cylinder, block = (mass * (k * half**2 + height**2 / 3.0) for k in (0.25, 1.0 / 3.0))
        words += f": here {1e6 * cylinder:.3g} and {1e6 * block:.3g} kg mm²"
    return f"{words}, and the gripper's share is added"


def check_centre(stated: Mapping[str, object], changes: Iterable[str]) -> None:
    """Refuse changes that would move the mass centre of a file that states ``centre_height``.

    Raises:
        ValueError: half_height or length is among the changes, without centre_height.
    """
    names = set(changes)
    if stated.get("centre_height") is None or "centre_height" in names:
        return
    for name in sorted(names & {"half_height", "length"}):
        raise ValueError(
            f"{name}: would move the mass centre, which the file states by centre_height: set "
            "centre_height"
        )


def replaced_by(changes: Iterable[str]) -> set[str]:
    """Return the quantities of a file that no longer hold if those in ``changes`` are changed.

    They state the same as a change, or a changed parameter would be computed from them.
    """
    names = set[str]()
    for each in changes:
        parameter = "clearance" if each == "fit" else each
        parameter = parameter_of(parameter)
        names |= {parameter, *SOURCES.get(parameter, ())}
        names |= {"fit"} if parameter == "clearance" else set()
    return names - set(changes)
