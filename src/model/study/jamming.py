"""The textbook's statics of jamming in the slot, for the runs of the sweep "jamming".

A peg of width d = 2a that stands tilted by φ in a slot of width D = d (1 + δ) touches it at two
points, an edge of the slot on one side and a bottom corner on the opposite wall, at the depth h
with D = d cos φ + h sin φ. Friction alone holds it there, without any outer force, if the line
between the two points lies in both friction cones, h < μ d: it is wedged. Sources: S. Simunovic,
Force information in assembly processes (1975); D. E. Whitney, Quasi-static assembly of compliantly
supported rigid parts, J. Dyn. Syst. Meas. Control 104 (1982) 65-77, where c/φ stands for h/d at
small tilts, with c = (D - d)/D.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import PARAMETER_NAMES

Array = NDArray[np.float64]


def depth_of_two_points(tilt: Array, clearance: float | Array) -> Array:
    """Return the depth h/d, over the part's width, at which it touches two points at a tilt.

    It is also the friction above which the part is wedged there.
    """
    return np.asarray((1.0 + clearance - np.cos(tilt)) / np.sin(tilt))


def tilt_at_depth(depth: float, clearance: float) -> float:
    """Return the tilt at which a part touches two points at a depth h/d.

    A part with a larger tilt cannot go so deep: it must turn upright on the way.
    """
    # cos φ + (h/d) sin φ = 1 + δ, on the branch of small tilts.
    reach = np.hypot(1.0, depth)
    return float(np.arctan(depth) - np.arccos(min(1.0, (1.0 + clearance) / reach)))


def in_jamming_diagram(dataset: xr.Dataset) -> tuple[Array, Array]:
    """Return the place of each part in the jamming diagram of two-point contact.

    Press and springs load the part at its tip by Fz along its axis, Fx across and M, at the tilt at
    entry and the depth h at which it then touches two points. With r = a and λ = h/(2 r μ) it is
    driven on inside a parallelogram, |μ Fx/Fz| < 1 and |M/(r Fz) + μ (1 + λ) Fx/Fz| < λ.

    Returns:
        μ Fx/Fz, and the second expression over λ: the parallelogram becomes a square of half-width
        1. Both in the dimensions of the dataset; NaN where no part falls in, or Fz <= 0.
    """
    entry = dataset["tilt_at_alignment"].where(np.isfinite(dataset["tau_align"]))
    entry = entry.where(entry > 0.0)
    p = {name: (0.0 * entry + dataset[name]).values for name in PARAMETER_NAMES}
    a, b, tilt = p["half_width"], p["half_height"], entry.values
    sine, cosine = np.sin(tilt), np.cos(tilt)
    h_over_d = depth_of_two_points(tilt, p["clearance"])
    depth = 2.0 * a * h_over_d
    # The corner B2 is that far from A2 along the side face.
    x = -a * (1.0 + p["clearance"]) + depth * sine + a * cosine - b * sine
    y = -depth * cosine + a * sine + b * cosine
    rest_x = np.where(np.isnan(p["rest_x"]), p["misalignment"], p["rest_x"])
    rest_y = np.where(np.isnan(p["rest_y"]), b, p["rest_y"])
    force_x, force_y = p["lateral_stiffness"] * (rest_x - x), rest_y - y - p["press_force"]
    across, inward = force_x * cosine + force_y * sine, force_x * sine - force_y * cosine
    inward = np.where(inward > 0.0, inward, np.nan)
    moment = p["tilt_stiffness"] * (p["rest_tilt"] - tilt) - b * across
    ratio = h_over_d / p["friction"]
    sideways = p["friction"] * across / inward
    return sideways, (moment / (a * inward) + (1.0 + ratio) * sideways) / ratio


def entered(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Return which parts fall into the slot."""
    return np.isfinite(dataset["tau_align"].values)


def wedging_side(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Return which parts have a friction above the wedging limit at their tilt at entry."""
    tilt = dataset["tilt_at_alignment"].values
    clearance = dataset["clearance"].values[:, None, None]
    limit = depth_of_two_points(np.where(tilt > 0.0, tilt, np.nan), clearance)
    return np.asarray(dataset["friction"].values > limit)


def jammed(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Return which parts fall in and stay there, not inserted."""
    return np.asarray(dataset["outcome"].values == Outcome.JAMMED)
