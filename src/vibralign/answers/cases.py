"""Cases that a device meets: starts, and bases where none is stated.

Where a device states no base, a *base* is chance as phase and tilt at touch-down are. It has one of
``LEVELS`` stiffnesses, from ``SOFTEST`` times the axial stiffness to that of steel on steel under
the press force with an edge as round as the part is wide (Hertz's law, base.py), and one of
``RESTITUTIONS``. The base that ``simulate`` takes is tried from every start, any other from every
fourth, in turn.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from model.physics.geometry import lever_if_flat
from model.physics.parameters import Batch, Parameters, Shape
from model.physics.units import Units
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts, starts_of
from vibralign.device.base import MATERIALS, damping_ratio_of, hertz_stiffness
from vibralign.device.stated import StatedDevice

SOFTEST = 100.0  # contact stiffness over axial stiffness
LEVELS = 4  # stiffnesses, the logarithms equidistant
RESTITUTIONS = (0.3, 0.8)  # tried where no impact is stated
OF_BASE = ("level", "restitution")
"""Names of a case besides those of its start: the base's stiffness, 0 to 1 on its logarithmic
range, and its restitution. NaN for a stiffness or a damping that is the device's own."""

_EVERY = 4  # of the starts, tried on each base
_STEEL = MATERIALS["steel"]


def cases_of(
    device: Parameters | StatedDevice, ensemble: Ensemble, *, bases: bool = False
) -> Starts:
    """Return the cases of a device: its starts, on the bases too if none is stated or ``bases``."""
    if isinstance(device, Parameters):
        return starts_of(device, ensemble)
    starts = starts_of(device.parameters, ensemble)
    if device.base_is_stated and not bases:
        return starts
    impacts: Sequence[float] = RESTITUTIONS
    if "contact_damping" in device.quantities:
        impacts = (math.nan,)
    elif "restitution" in device.quantities:
        impacts = (device.quantities["restitution"],)
    own = dict.fromkeys(OF_BASE, math.nan)
    cases: list[Mapping[str, float]] = [{**start, **own} for start in starts]
    levels = np.linspace(0.0, 1.0, LEVELS).tolist()
    for number, base in enumerate(product(impacts, levels)):
        of_base = dict(zip(reversed(OF_BASE), base, strict=True))
        cases += [{**start, **of_base} for start in starts[number % _EVERY :: _EVERY]]
    return cases


def on_bases(
    devices: Batch, units: Sequence[Units], cases: Starts, shape: Shape
) -> dict[str, NDArray[np.float64]]:
    """Return contact stiffness and damping of devices in all cases, shape (devices, cases).

    Dimensionless; empty if the cases have no bases.
    """
    if OF_BASE[0] not in cases[0]:
        return {}
    level, restitution = (np.array([case[name] for case in cases]) for name in OF_BASE)
    given = {name: column[:, None] for name, column in devices.values.items()}
    radius = given["half_width"][:, 0] * [each.amplitude for each in units]
    force = given["press_force"][:, 0] * [each.force for each in units]
    stiffest = hertz_stiffness((_STEEL, _STEEL), 1.0, 1.0) * np.cbrt(radius * force)
    stiffest = (stiffest / [each.axial_stiffness for each in units])[:, None]
    softest = np.minimum(SOFTEST, stiffest)
    found = softest * (stiffest / softest) ** level
    stiffness = np.where(np.isnan(level), given["contact_stiffness"], found)
    ratio = np.array([math.nan if math.isnan(e) else damping_ratio_of(e) for e in restitution])
    hole = given["half_width"] * (1.0 + given["clearance"])
    arm = lever_if_flat(given["half_width"], hole, given["misalignment"], shape)
    mass = 1.0 / (1.0 + arm * arm / given["inertia"])
    damping = 2.0 * ratio * np.sqrt(stiffness * mass)
    damping = np.where(np.isnan(ratio), given["contact_damping"], damping)
    return {"contact_stiffness": stiffness, "contact_damping": damping}


def stated_case(device: Parameters | StatedDevice, case: Mapping[str, float]) -> dict[str, float]:
    """Return what states a case of a device, in SI units or dimensionless as the device is."""
    if isinstance(device, Parameters) or OF_BASE[0] not in case:
        return dict(case)
    stated = {name: value for name, value in case.items() if name not in OF_BASE}
    if not math.isnan(case["level"]):
        column = on_bases(Batch.stack([device.parameters]), [device.units], [case], device.shape)
        own = float(column["contact_stiffness"][0, 0]) * device.units.axial_stiffness
        stated["contact_stiffness"] = own
        if not math.isnan(case["restitution"]):
            stated["restitution"] = case["restitution"]
    return stated


def parameters_in(device: Parameters | StatedDevice, case: Mapping[str, float]) -> Parameters:
    """Return the parameters of a device in a case."""
    stated = stated_case(device, case)
    if isinstance(device, Parameters):
        return device.replace(**stated)
    return device.at(stated).parameters
