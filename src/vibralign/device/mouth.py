"""The mouth of the hole: what a device states there, as parameters of the model.

A robot and a fixture leave a distance m between the axes of part and hole *at the mouth*, where the
part touches down, and a gripper holds it with a tilt φ. The mass centre is at the height b over the
middle of the bottom face, and the springs are relaxed where the robot brings the part, so that

    x(0) = x_st = m - b sin φ,    φ(0) = φ_st = φ.

A chamfer of 45° makes the bottom face narrower (of width c_p, on the part) or the mouth wider (c_h,
on the hole). Until the face lies within the mouth, the pair acts as one without chamfers, of

    a' = a - c_p,    l' = a (1 + δ) + c_h,    δ' = l'/a' - 1,

as long as the normal at the contact stays within the cones of the flanks, which it does while
l' sin φ <= l' cos φ - a', and nothing touches the side of the part.

All in SI units, angles in radians; numbers, or arrays of devices.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from model.events.outcomes import Outcome, Reason
from model.physics.fields import Field
from model.physics.quantities import ANGLE, LENGTH

GRIPPER_TILT = "gripper_tilt"
CHAMFERS = ("peg_chamfer", "hole_chamfer")
_CHAMFER = "width of the chamfer of the {}, of 45°, across the axis"
MOUTH: Mapping[str, Field] = {
    "misalignment": Field(
        "m", "distance of the axes of part and hole at the mouth of the hole", LENGTH, ">= 0"
    ),
    GRIPPER_TILT: Field(
        "φ_st", "tilt at which the gripper holds the part; > 0: the face dips into the hole", ANGLE
    ),
    "peg_chamfer": Field("c_p", _CHAMFER.format("part"), LENGTH, ">= 0"),
    "hole_chamfer": Field("c_h", _CHAMFER.format("hole"), LENGTH, ">= 0"),
}
"""Quantities that a device states at the mouth of the hole."""

_RELAXED = "the springs are relaxed where the part touches down"
REPLACED: Mapping[str, str] = {
    "initial_tilt": f"write {GRIPPER_TILT}, the tilt at which the part is held and touches down",
    "rest_tilt": f"write {GRIPPER_TILT}, the tilt at which the part is held and touches down",
    "rest_x": f"leave it out: {_RELAXED}, which misalignment and {GRIPPER_TILT} state",
    "rest_y": f"leave it out: {_RELAXED}; state press_force",
}
"""Parameters that follow from these quantities, and what a device file states in their place."""


def check_not_replaced(name: str) -> None:
    """Refuse a parameter that is no quantity of a device, with what to write instead."""
    if name in REPLACED:
        raise ValueError(f"{name}: is no quantity of a device: {REPLACED[name]}")


def as_parameters(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return quantities with parameters in place of ``MOUTH``.

    A missing quantity is missing in the result as well.

    Raises:
        ValueError: a quantity of ``MOUTH`` outside its rule.
    """
    for name in MOUTH.keys() & given.keys():
        outside = ~np.atleast_1d(MOUTH[name].admits(np.asarray(given[name])))
        if outside.any():
            value = float(np.atleast_1d(given[name])[int(np.argmax(outside))])
            raise ValueError(f"{name} = {value!r}: {MOUTH[name].rule}")
    found = {name: value for name, value in given.items() if name not in MOUTH}
    if not {"misalignment", "half_width", "half_height", "clearance"} <= given.keys():
        return found | {n: v for n, v in given.items() if n == "misalignment"}
    tilt = given.get(GRIPPER_TILT, 0.0)
    return {**found, **_pair(given), **start_of(given["misalignment"], given["half_height"], tilt)}


def _pair(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return half-width and clearance of the pair that chamfers leave; empty without chamfers."""
    if not given.keys() & {*CHAMFERS}:
        return {}
    half, chamfer = given["half_width"], given.get("peg_chamfer", 0.0)
    if np.any(chamfer >= half):
        raise ValueError(
            f"peg_chamfer = {float(np.max(chamfer))!r}: must be smaller than half_width, or no "
            "face is left"
        )
    mouth = half * (1.0 + given["clearance"]) + given.get("hole_chamfer", 0.0)
    return {"half_width": half - chamfer, "clearance": mouth / (half - chamfer) - 1.0}


def start_of(misalignment: Any, half_height: Any, tilt: Any) -> dict[str, Any]:
    """Return the parameters of the start: x(0), φ(0) and φ_st; in any one unit of length."""
    x = misalignment - half_height * np.sin(tilt)
    return {"misalignment": x, "initial_tilt": tilt, "rest_tilt": tilt}


def middle_of_face(parameters: Mapping[str, Any]) -> Any:
    """Return where the middle of the bottom face is at the start, x(0) + b sin φ(0)."""
    tilt = parameters.get("initial_tilt", 0.0)
    return parameters["misalignment"] + parameters["half_height"] * np.sin(tilt)


_AT_ONCE: Mapping[str, float] = {
    "outcome": Outcome.ALIGNED, "reason": Reason.NONE, "tau_align": 0.0, "tau_error": 0.0,
}  # fmt: skip
_BY_PRESS = {**_AT_ONCE, "reason": Reason.BY_PRESS}
_ON_FLANK: Mapping[str, float] = {
    "outcome": Outcome.LEFT_SCENE, "reason": Reason.ON_FLANK,
    **dict.fromkeys(("tau_align", "tau_error", "tau_corners_inside"), math.nan),
}  # fmt: skip


def judged(
    results: Mapping[str, Any], parameters: Mapping[str, Any], *, chamfered: bool
) -> dict[str, Any]:
    """Return the results of runs by name, changed where the place at the mouth decides.

    A part that starts inside the hole needs no alignment, and is aligned at once, even if it meets
    no edge and hangs in the hole. If the part of a ``chamfered`` pair meets a flank or a side, its
    alignment is not known. Both mappings hold arrays of one shape.
    """
    at_once = is_inside(parameters, parameters["initial_tilt"])
    found = _with(results, at_once & (results["tau_align"] != 0.0), _AT_ONCE)
    if chamfered:
        tilt = np.fmax(results["tilt_max"], np.abs(results["tilt_at_alignment"]))
        beyond = (tilt > steepest(parameters)) | (results["side_force_max"] > 0.0)
        found = _with(found, beyond & ~at_once & np.isfinite(results["tau_align"]), _ON_FLANK)
    return found


def judged_on_chamfers(
    results: Mapping[str, Any], parameters: Mapping[str, Any], widths: tuple[Any, Any]
) -> dict[str, Any]:
    """Return the results of runs by name, changed where the part lands with flank on flank.

    The press alone brings it in if it is large enough (``press_to_slide``); else it is not known
    whether it goes in. ``widths`` are those of the chamfers of part and hole.
    """
    half = parameters["half_width"] + widths[0]
    mouth = parameters["half_width"] * (1.0 + parameters["clearance"]) - widths[1]
    tilt, bare = parameters["initial_tilt"], {"half_width": half, "clearance": mouth / half - 1.0}
    meet = is_inside(parameters, tilt) & ~is_inside({**parameters, **bare}, tilt)
    given = {**parameters, **bare, "misalignment": middle_of_face(parameters)}
    slides = parameters["press_force"] > press_to_slide(given)
    return _with(_with(results, meet & slides, _BY_PRESS), meet & ~slides, _ON_FLANK)


def _with(results: Mapping[str, Any], where: Any, what: Mapping[str, float]) -> dict[str, Any]:
    changed = {
        name: np.where(where, what[name], results[name]).astype(results[name].dtype)
        for name in what.keys() & results.keys()
    }
    return {**results, **changed}


def steepest(parameters: Mapping[str, Any]) -> Any:
    """Return the tilt up to which the flanks of a chamfered pair are not met."""
    return np.arccos(math.sqrt(0.5) / (1.0 + parameters["clearance"])) - 0.25 * math.pi


def press_to_slide(given: Mapping[str, Any]) -> Any:
    """Return the press above which a part whose chamfers meet slides in along a flank.

    The flank moves the face by the misalignment less the play, against the lateral and the tilt
    spring in series. The press is infinite for a friction of 1 or more. In any consistent units.
    """
    across = np.maximum(given["misalignment"] - given["clearance"] * given["half_width"], 0.0)
    friction = np.asarray(given["friction"])
    with np.errstate(divide="ignore", invalid="ignore"):
        compliance = np.divide(1.0, given["lateral_stiffness"])
        compliance = compliance + np.divide(given["half_height"] ** 2, given["tilt_stiffness"])
        press = across / compliance * (1.0 + friction) / (1.0 - friction)
    return np.where(friction < 1.0, press, math.inf)


def is_inside(parameters: Mapping[str, Any], tilt: Any) -> Any:
    """Return whether a face that is tilted so starts within the hole, and meets no edge."""
    half = parameters["half_width"]
    play = half * (1.0 + parameters["clearance"]) - half * np.cos(tilt)
    return middle_of_face(parameters) <= play
