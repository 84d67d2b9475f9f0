"""The holder of a device: damping from damping ratios, natural frequencies.

Without contact the part in its holder is three oscillators (equations (3) without contact forces):
along the axis with stiffness K_Y and mass M, across it with k_x and M, in tilt with k_φ and I_φ.
Each has the natural angular frequency √(k/m), and the damping h = 2ζ √(k m) at the ratio ζ.
"""

import math
from collections.abc import Mapping

from model.physics.parameters import Parameters

DIRECTIONS = ("axial", "lateral", "tilt")
# Damping ratios that a device file may state, and the parameters that they replace.
RATIOS: Mapping[str, str] = {f"{each}_damping_ratio": f"{each}_damping" for each in DIRECTIONS}


def mass_and_stiffness(direction: str) -> tuple[str, str]:
    """Return the names of the inertial quantity and of the stiffness of an oscillator."""
    return "inertia" if direction == "tilt" else "mass", f"{direction}_stiffness"


def critical_damping(direction: str, quantities: Mapping[str, float]) -> float:
    """Return the damping of an oscillator at the ratio 1, in SI units as the ``quantities``."""
    mass, stiffness = mass_and_stiffness(direction)
    return 2.0 * math.sqrt(quantities[stiffness] * quantities[mass])


def with_damping(quantities: Mapping[str, float]) -> dict[str, float]:
    """Return quantities in SI units, with dampings in place of damping ratios.

    Raises:
        ValueError: a ratio < 0 or not finite, one without its stiffness or mass, or a damping that
            is stated as well.
    """
    result = {name: value for name, value in quantities.items() if name not in RATIOS}
    for name, damping in RATIOS.items():
        if name not in quantities:
            continue
        value, direction = quantities[name], damping.removesuffix("_damping")
        if not 0.0 <= value < math.inf:
            raise ValueError(f"{name} = {value!r}: must be a finite number >= 0")
        if damping in quantities:
            raise ValueError(f"{damping} and {name} state the same: leave one out")
        for each in mass_and_stiffness(direction):
            if not quantities.get(each, -1.0) >= 0.0:
                raise ValueError(f"{name} needs {each}, a number >= 0")
        result[damping] = value * critical_damping(direction, quantities)
    return result


def natural_frequencies(parameters: Parameters) -> dict[str, float]:
    """Return the natural frequency of each of ``DIRECTIONS``, dimensionless as ``frequency``."""
    tilt = math.sqrt(parameters.tilt_stiffness / parameters.inertia)
    return dict(zip(DIRECTIONS, (1.0, math.sqrt(parameters.lateral_stiffness), tilt), strict=True))
