"""The holder of a device: damping from damping ratios, natural frequencies.

Without contact the part in its holder is three oscillators (equations (3) without contact forces):
along the axis with stiffness K_Y and mass M, across it with k_x and M, in tilt with k_φ and I_φ.
Each has the natural angular frequency √(k/m), and the damping h = 2ζ √(k m) at the ratio ζ.
"""

import math
from collections.abc import Mapping

from model.physics.parameters import Parameters

DIRECTIONS = ("axial", "lateral", "tilt")


def mass_and_stiffness(direction: str) -> tuple[str, str]:
    """Return the names of the inertial quantity and of the stiffness of an oscillator."""
    return "inertia" if direction == "tilt" else "mass", f"{direction}_stiffness"


def critical_damping(direction: str, quantities: Mapping[str, float]) -> float:
    """Return the damping of an oscillator at the ratio 1, in SI units as the ``quantities``."""
    mass, stiffness = mass_and_stiffness(direction)
    return 2.0 * math.sqrt(quantities[stiffness] * quantities[mass])


def natural_frequencies(parameters: Parameters) -> dict[str, float]:
    """Return the natural frequency of each of ``DIRECTIONS``, dimensionless as ``frequency``."""
    tilt = math.sqrt(parameters.tilt_stiffness / parameters.inertia)
    return dict(zip(DIRECTIONS, (1.0, math.sqrt(parameters.lateral_stiffness), tilt), strict=True))
