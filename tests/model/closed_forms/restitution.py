"""Restitution of a base that only pushes, and the damping for it.

Source: T. Schwager and T. Pöschel, Coefficient of restitution and linear-dashpot model revisited,
Granular Matter 9 (2007) 465-469.
"""

from math import atan2, exp, pi, sqrt


def pushing(stiffness, damping):
    """Restitution of a dashpot that only pushes, until its force vanishes (their eq. 20)."""
    decay = damping / 2
    omega = sqrt(stiffness - decay**2)
    return exp(-decay / omega * (pi - atan2(2 * decay * omega, omega**2 - decay**2)))


def damping_for(restitution, stiffness):
    """Damping of a base with this restitution of ``pushing``, by bisection."""
    low, high = 0.0, 1.999 * sqrt(stiffness)
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pushing(stiffness, middle) > restitution else (low, middle)
    return low
