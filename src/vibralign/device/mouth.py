"""The mouth of the hole: what a device states there, as parameters of the model.

A robot and a fixture leave a distance m between the axes of part and hole *at the mouth*, where the
part touches down, and a gripper holds it with a tilt φ. The mass centre is at the height b over the
middle of the bottom face, and the springs are relaxed where the robot brings the part, so that

    x(0) = x_st = m - b sin φ,    φ(0) = φ_st = φ.

All in SI units, angles in radians; numbers, or arrays of devices.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from model.events.outcomes import Outcome, Reason
from model.physics.fields import Field
from model.physics.quantities import ANGLE, LENGTH

GRIPPER_TILT = "gripper_tilt"
MOUTH: Mapping[str, Field] = {
    "misalignment": Field(
        "m", "distance of the axes of part and hole at the mouth of the hole", LENGTH, ">= 0"
    ),
    GRIPPER_TILT: Field(
        "φ_st", "tilt at which the gripper holds the part; > 0: the face dips into the hole", ANGLE
    ),
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
    if not {"misalignment", "half_height"} <= given.keys():
        return found | {n: v for n, v in given.items() if n == "misalignment"}
    tilt = given.get(GRIPPER_TILT, 0.0)
    return found | start_of(given["misalignment"], given["half_height"], tilt)


def start_of(misalignment: Any, half_height: Any, tilt: Any) -> dict[str, Any]:
    """Return the parameters of the start: x(0), φ(0) and φ_st; in any one unit of length."""
    x = misalignment - half_height * np.sin(tilt)
    return {"misalignment": x, "initial_tilt": tilt, "rest_tilt": tilt}


def at_mouth(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return ``MOUTH`` in place of the parameters of a device: ``as_parameters`` backwards."""
    kept = {name: each for name, each in parameters.items() if name not in REPLACED}
    start = {"misalignment": middle_of_face(parameters), GRIPPER_TILT: parameters["initial_tilt"]}
    return kept | start


def middle_of_face(parameters: Mapping[str, Any]) -> Any:
    """Return where the middle of the bottom face is at the start, x(0) + b sin φ(0)."""
    tilt = parameters.get("initial_tilt", 0.0)
    return parameters["misalignment"] + parameters["half_height"] * np.sin(tilt)


def judged(results: Mapping[str, Any], parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the results of runs, with those of parts that start inside the hole.

    Such a part needs no alignment, and is aligned at once, even if it meets no edge and hangs in
    the hole. Both mappings hold arrays of one shape.
    """
    at_once = is_inside(parameters, parameters["initial_tilt"]) & (results["tau_align"] != 0.0)
    said = {"outcome": Outcome.ALIGNED, "reason": Reason.NONE, "tau_align": 0.0, "tau_error": 0.0}
    return {
        name: np.where(at_once, said[name], column).astype(column.dtype) if name in said else column
        for name, column in results.items()
    }


def is_inside(parameters: Mapping[str, Any], tilt: Any) -> Any:
    """Return whether a face that is tilted so starts within the hole, and meets no edge."""
    half = parameters["half_width"]
    play = half * (1.0 + parameters["clearance"]) - half * np.cos(tilt)
    return middle_of_face(parameters) <= play
