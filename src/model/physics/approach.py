"""The start that a robot makes: the holder is lowered at a constant speed until it presses with f0.

It is lowered along the axis, and with it the place at which the axial spring is relaxed. That is a
press P(τ) that grows at the rate v (K_Y = 1) and then stays (forces.py):

    P(τ) = f0 - v max(τ_e - τ, 0)

Before the part touches the base it is in a steady *descent*, which lags behind the holder because
the axial damper is grounded. With the excitation -sin(ντ + θ) of (3),

    y = y_st - P + h_y v - Im[e^{i(ντ + θ)} / (1 - ν² + i h_y ν)],   ẏ = dy/dτ,   dP/dτ = v

solves (3) exactly up to τ_e; without vibration the last term is missing. A run begins in it where
the part just clears the base at every phase, at its place x(0) and with the tilt of its gripper.
"""

from math import sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.kernels import inlined_kernel, kernel
from model.physics.motion import motion_at
from model.physics.trigonometry import sine_cosine

Start = Literal["simultaneous", "pressed", "running", "still"]
"""Start of a run.

simultaneous: the press and the vibration set in at once, on a part that touches the base without
load (paper). pressed: the press has risen slowly, and the part rests under it before it vibrates
(rest.py). running: the part is lowered onto the base while it vibrates. still: it is lowered,
pressed and comes to rest, and then the vibration sets in.
"""
SIMULTANEOUS, PRESSED, RUNNING, STILL = range(4)  # numbers of the starts in kernels

AT_REST = 1e-3  # speed and acceleration below which a part is at rest, in units of the vibration's
_CLEARING = 1e-3  # height over the base at which a descent begins, besides the swing


class Descent(NamedTuple):
    """Height and speed of the mass centre as a run begins, and the end of the ramp."""

    y: float
    y_rate: float
    ramp_end: float


@inlined_kernel
def _swing(p):
    """Return (swing, its rate, its amplitude): Im[e^{iθ}/(1 - ν² + i h_y ν)] at τ = 0."""
    sine, cosine = sine_cosine(p.phase)
    real, imaginary = 1.0 - p.frequency * p.frequency, p.axial_damping * p.frequency
    square = real * real + imaginary * imaginary
    swing = (sine * real - cosine * imaginary) / square
    rate = p.frequency * (cosine * real + sine * imaginary) / square
    return swing, rate, 1.0 / sqrt(square)


@kernel
def descent(touching, vibrates, p):
    """Return the ``Descent`` of a part that touches the base at the height ``touching``.

    A holder that would reach its place before then begins to be lowered there.
    """
    swing, rate, amplitude = _swing(p) if vibrates else (0.0, 0.0, 0.0)
    lag = p.axial_damping * p.press_rate
    clear = touching + amplitude + _CLEARING
    lack = max(clear - (p.rest_y - p.press_force + lag), 0.0)
    y = p.rest_y - p.press_force + lack + lag
    return Descent(y - swing, -p.press_rate - rate, lack / p.press_rate)


@kernel
def is_at_rest(time, q, p, mode):
    """Return whether neither speeds nor accelerations of any point exceed ``AT_REST``."""
    at, arm = motion_at(time, q, p, mode), p.half_width + p.half_height
    speed = abs(q.x_rate) + abs(q.y_rate) + arm * abs(q.tilt_rate)
    return speed <= AT_REST and abs(at.x) + abs(at.y) + arm * abs(at.tilt) <= AT_REST


def rows_of_start(
    rows: NDArray[np.float64], constants: Any, start: Start | None
) -> NDArray[np.float64]:
    """Return rows of constants, shape (n, constants), as a start needs them.

    The tilt at an approach is that of the gripper, φ_st. ``constants`` are the places by name.

    Raises:
        ValueError: a start needs an approach speed, or has no use for one, or is lowered vibrating
            in resonance without damping.
    """
    speeds = rows[:, constants.press_rate]
    if start not in ("running", "still"):
        if np.any(speeds > 0.0):
            raise ValueError(
                f"approach_speed = {speeds.max():g}: has no effect on the start "
                f"{start or 'simultaneous'!r}; leave it out, or choose the start 'running' or "
                "'still'"
            )
        return rows
    if np.any(speeds == 0.0):
        raise ValueError(f"approach_speed = None: the start {start!r} needs a number > 0")
    resonant = (rows[:, constants.axial_damping] == 0.0) & (rows[:, constants.frequency] == 1.0)
    if start == "running" and resonant.any():
        raise ValueError(
            "frequency = 1.0: without axial damping the vibration grows without bounds in this "
            "resonance before the part touches; state axial_damping, or another frequency"
        )
    rows = rows.copy()
    rows[:, constants.initial_tilt] = rows[:, constants.rest_tilt]
    return rows
