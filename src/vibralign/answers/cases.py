"""Cases that a device meets: starts, approaches and bases where none is stated.

If a device states no base, its *base* is left to chance, like phase and tilt at touch-down. It has
one of ``LEVELS`` stiffnesses, from ``SOFTEST`` times the axial stiffness to that of steel on steel
under the press force with an edge as round as the part is wide (Hertz's law, base.py), and one of
``RESTITUTIONS``. The base that ``simulate`` takes is tried from every start, each other base from
every fourth, in turn.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch, Parameters, Shape
from model.physics.units import Units
from model.sweeps.settings import Ensemble
from model.sweeps.starts import Starts, tilts_and_phases
from vibralign.device.approach import SPEED, Approach
from vibralign.device.base import (
    MATERIALS,
    damping_ratio_of,
    hertz_stiffness,
    in_series,
    mass_at_edge,
)
from vibralign.device.mouth import GRIPPER_TILT, middle_of_face, start_of
from vibralign.device.stated import StatedDevice

SOFTEST = 100.0  # contact stiffness over axial stiffness
LEVELS = 4  # stiffnesses, the logarithms equidistant
RESTITUTIONS = (0.3, 0.8)  # tried where no impact is stated
USUAL_TILT = math.radians(0.1)  # of a gripper, either way, tried where none is stated
OF_BASE = ("level", "restitution")
"""Names of a case besides those of its start: the base's stiffness, 0 to 1 on its logarithmic
range, and its restitution. NaN for a stiffness or a damping that is the device's own."""
OF_APPROACH = (SPEED, "vibrates")
"""Names of a case that tell its approach: speed in m/s, and 1.0 or 0.0 for the vibrator."""

_EVERY = 4  # of the starts, tried on each base
_STEEL = MATERIALS["steel"]


def tilts_of(device: StatedDevice) -> list[float]:
    """Return the gripper's tilts that are tried, in rad: its own, and the ends of its tolerance."""
    own = device.quantities.get(GRIPPER_TILT, 0.0)
    tolerance = device.tolerances.get(GRIPPER_TILT)
    if tolerance is not None:
        left = tolerance.end(own)
    else:
        left = 0.0 if GRIPPER_TILT in device.quantities else USUAL_TILT
    return [own, own - left, own + left] if left else [own]


def _starts_of(device: StatedDevice, ensemble: Ensemble, *, tilts: bool) -> Starts:
    """Return the starts of a device: each phase, at each tilt of the gripper unless these vary."""
    _, phases = tilts_and_phases(device.parameters, ensemble)
    starts = [{"phase": phase} for phase in phases]
    return at_each_tilt(device, starts) if tilts else starts


def at_each_tilt(device: StatedDevice, starts: Starts) -> Starts:
    """Return the starts at each tilt of the gripper that is tried, if there are several."""
    tried = tilts_of(device)
    if len(tried) == 1 or GRIPPER_TILT in starts[0]:
        return starts
    return [{**each, GRIPPER_TILT: tilt} for tilt in tried for each in starts]


def _approaching(approach: Approach, starts: Starts) -> Starts:
    """Return the starts with an approach."""
    speed = {} if approach.speed is None else {SPEED: approach.speed}
    return [{**each, **speed, "vibrates": float(approach.vibrator == "running")} for each in starts]


def without_approach(case: Mapping[str, float]) -> dict[str, float]:
    """Return a case without its approach, for a device that states one."""
    return {name: value for name, value in case.items() if name not in OF_APPROACH}


def by_approach(
    device: StatedDevice, cases: Starts
) -> list[tuple[StatedDevice, NDArray[np.int64], Starts]]:
    """Return (device, places, cases) for each approach of the cases, which then have none."""
    keys = [tuple(case.get(name) for name in OF_APPROACH) for case in cases]
    found: list[tuple[StatedDevice, NDArray[np.int64], Starts]] = []
    for key in dict.fromkeys(keys):
        places = np.array([n for n, each in enumerate(keys) if each == key])
        lowered = device.lowered(approach_of(cases[int(places[0])]))
        found.append((lowered, places, [without_approach(cases[i]) for i in places]))
    return found


def approach_of(case: Mapping[str, float]) -> Approach | None:
    """Return the approach of a case; None if it has none of its own."""
    if "vibrates" not in case:
        return None
    return Approach("running" if case["vibrates"] else "still", case.get(SPEED))


def cases_of(device: StatedDevice, ensemble: Ensemble, *, varied: Collection[str] = ()) -> Starts:
    """Return the cases of a device: its starts; on bases, too, if it states none.

    If the gripper's tilt is among the quantities that are ``varied``, the cases have no tilt.
    """
    starts = _starts_of(device, ensemble, tilts=GRIPPER_TILT not in varied)
    approaches = device.approaches(varied)
    if len(approaches) > 1:
        starts = [case for each in approaches for case in _approaching(each, starts)]
    if device.base_is_stated:
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
    devices: Batch,
    units: Sequence[Units],
    cases: Starts,
    shape: Shape,
    fixture: NDArray[np.float64] | float = math.inf,
) -> dict[str, NDArray[np.float64]]:
    """Return contact stiffness and damping of devices in all cases, shape (devices, cases).

    Dimensionless; empty if the cases have no bases. ``fixture`` is the stiffness in N/m that is in
    series with the bases tried, shape (devices,) or ().
    """
    if OF_BASE[0] not in cases[0]:
        return {}
    level, restitution = (np.array([case[name] for case in cases]) for name in OF_BASE)
    given = {name: column[:, None] for name, column in devices.values.items()}
    radius = given["half_width"][:, 0] * [each.amplitude for each in units]
    force = given["press_force"][:, 0] * [each.force for each in units]
    stiffest = hertz_stiffness((_STEEL, _STEEL), 1.0, 1.0) * np.cbrt(radius * force)
    axial = np.array([each.axial_stiffness for each in units])
    stiffest = (stiffest / axial)[:, None]
    softest = np.minimum(SOFTEST, stiffest)
    found = in_series(softest * (stiffest / softest) ** level, (fixture / axial)[:, None])
    stiffness = np.where(np.isnan(level), given["contact_stiffness"], found)
    ratio = np.array([math.nan if math.isnan(e) else damping_ratio_of(e) for e in restitution])
    damping = 2.0 * ratio * np.sqrt(stiffness * mass_at_edge(given, shape))
    damping = np.where(np.isnan(ratio), given["contact_damping"], damping)
    return {"contact_stiffness": stiffness, "contact_damping": damping}


def at_tilts(devices: Batch, cases: Starts) -> dict[str, NDArray[np.float64]]:
    """Return the parameters that the cases' tilts change, shape (devices, cases); dimensionless.

    The misalignment at the mouth stays. Empty if the cases have no tilts.
    """
    if GRIPPER_TILT not in cases[0]:
        return {}
    given = {name: column[:, None] for name, column in devices.values.items()}
    tilts = np.array([case[GRIPPER_TILT] for case in cases])
    tilts = np.broadcast_to(tilts, (len(devices), len(cases)))
    return start_of(middle_of_face(given), given["half_height"], tilts)


def stated_case(device: StatedDevice, case: Mapping[str, float]) -> dict[str, float]:
    """Return the values that state a case of a device, but for its approach; in SI units."""
    device, case = device.lowered(approach_of(case)), without_approach(case)
    if OF_BASE[0] not in case:
        return dict(case)
    stated = {name: value for name, value in case.items() if name not in OF_BASE}
    if not math.isnan(case["level"]):
        column = on_bases(Batch.stack([device.parameters]), [device.units], [case], device.shape)
        own = float(column["contact_stiffness"][0, 0]) * device.units.axial_stiffness
        stated["contact_stiffness"] = own
        if not math.isnan(case["restitution"]):
            stated["restitution"] = case["restitution"]
    return stated


def parameters_in(device: StatedDevice, case: Mapping[str, float]) -> Parameters:
    """Return the parameters of a device in a case."""
    return device.lowered(approach_of(case)).at(stated_case(device, case)).parameters
