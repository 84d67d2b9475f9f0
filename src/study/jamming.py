"""Statics of jamming in the slot, from the textbooks, for the runs of the sweep "jamming".

A peg of width d = 2a, tilted by φ in a slot of width D = d (1 + δ), touches the slot at two points:
an edge of the slot on one side, and a bottom corner on the opposite wall. The depth h there follows
from D = d cos φ + h sin φ. The peg is *wedged* if friction holds it without any outer force: the
line between the two points lies in both friction cones, h < μ d. Sources: S. Simunovic,
Force information in assembly processes (1975); D. E. Whitney, Quasi-static assembly of compliantly
supported rigid parts, J. Dyn. Syst. Meas. Control 104 (1982) 65-77, where c/φ stands for h/d at
small tilts, with c = (D - d)/D.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.physics.parameters import OF_PAPER

Array = NDArray[np.float64]


def depth_of_two_points(tilt: Array, clearance: float | Array) -> Array:
    """Return the depth of two-point contact over the width of the part, h/d, at a tilt (rad).

    It is also the friction above which the part is wedged at this depth.
    """
    return np.asarray((1.0 + clearance - np.cos(tilt)) / np.sin(tilt))


def tilt_at_depth(depth: float, clearance: float) -> float:
    """Return the tilt (rad) of two-point contact at a depth h/d.

    It is the largest tilt at this depth: a part with a larger one must turn upright on its way.
    """
    # cos φ + (h/d) sin φ = 1 + δ, on the branch of small tilts.
    reach = np.hypot(1.0, depth)
    return float(np.arctan(depth) - np.arccos(min(1.0, (1.0 + clearance) / reach)))


def in_jamming_diagram(dataset: xr.Dataset) -> tuple[Array, Array]:
    """Return the coordinates of parts in the jamming diagram of two-point contact.

    A part has its tilt at entry, and the depth h of two-point contact at this tilt. Press and
    springs act on its tip: Fz along its axis, Fx across it, and the moment M. With r = a and
    λ = h/(2 r μ) they drive it on inside a parallelogram, |μ Fx/Fz| < 1 and
    |M/(r Fz) + μ (1 + λ) Fx/Fz| < λ.

    Returns:
        μ Fx/Fz, and the second expression divided by λ, so that the parallelogram becomes a square
        of half-width 1. Both have the shape of the dataset; NaN where no part falls in, or Fz <= 0.
    """
    entry = dataset["tilt_at_alignment"].where(np.isfinite(dataset["tau_align"]))
    entry = entry.where(entry > 0.0)
    p = {name: (0.0 * entry + dataset[name]).values for name in OF_PAPER}
    a, b, tilt = p["half_width"], p["half_height"], entry.values
    sine, cosine = np.sin(tilt), np.cos(tilt)
    h_over_d = depth_of_two_points(tilt, p["clearance"])
    depth = 2.0 * a * h_over_d
    # Position of the mass centre, from the distance of the corner B2 to A2 along the side face.
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
    """Return a mask of the parts that fall into the slot."""
    return np.isfinite(dataset["tau_align"].values)


def wedging_side(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Return a mask of the parts with a friction above the wedging limit at their tilt at entry."""
    tilt = dataset["tilt_at_alignment"].values
    clearance = dataset["clearance"].values[:, None, None]
    limit = depth_of_two_points(np.where(tilt > 0.0, tilt, np.nan), clearance)
    return np.asarray(dataset["friction"].values > limit)


def jammed(dataset: xr.Dataset) -> NDArray[np.bool_]:
    """Return a mask of the parts that fall in and jam."""
    return np.asarray(dataset["outcome"].values == Outcome.JAMMED)
