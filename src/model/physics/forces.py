"""The forces that act without contact, each as its share of the right-hand side of (3).

Forces are in units of F1, moments in units of F1²/K_Y. Contact forces are in contacts.py.
"""

from typing import NamedTuple

from model.compile.kernels import inlined_kernel, operation
from model.physics.trigonometry import sine_cosine


@inlined_kernel
def lateral_suspension(q, p):
    """Return the reaction R_X = -h_x ẋ - k_x (x - x_st)."""
    return -p.lateral_damping * q.x_rate - p.lateral_stiffness * (q.x - p.rest_x)


@inlined_kernel
def axial_suspension(q, p):
    """Return the reaction R_Y = -h_y ẏ - (y - y_st); K_Y scales to 1."""
    return -p.axial_damping * q.y_rate - (q.y - p.rest_y)


@inlined_kernel
def tilt_suspension(q, p):
    """Return the moment T_φ = -h_φ φ̇ - k_φ (φ - φ_st)."""
    return -p.tilt_damping * q.tilt_rate - p.tilt_stiffness * (q.tilt - p.rest_tilt)


@operation
def lack_of_press(time, p):
    """Return by how much the press falls short of f0: rate (τ_e - τ) until τ_e, then nothing."""
    lack = p.press_rate * (p.ramp_end - time)
    return max(0.0, lack)


@inlined_kernel
def press(time, p):
    """Return the pressing force, downward: -f0, and less while the holder is still lowered."""
    return -p.press_force + lack_of_press(time, p)


@inlined_kernel
def excitation(time, p):
    """Return -sin(ντ + phase), the kinematic excitation through the axial spring, amplitude 1."""
    sine, _ = sine_cosine(p.frequency * time + p.phase)
    return -sine


class Applied(NamedTuple):
    """Resultant of the forces that act without contact, and their moment."""

    x: float
    y: float
    moment: float


@inlined_kernel
def applied_forces(time, q, p):
    """``Applied`` in the state ``q`` at ``time``: a force added here acts in every run."""
    return Applied(
        lateral_suspension(q, p),
        axial_suspension(q, p) + press(time, p) + excitation(time, p),
        tilt_suspension(q, p),
    )
