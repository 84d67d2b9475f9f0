"""Plausibility of a device: values that make no sense are refused, doubtful ones are named."""

import math
from collections.abc import Mapping

from model.physics.units import Device

_LONGEST = 1.0  # m
_GYRATION = 4.0  # factor between the radius of gyration and that of a rectangle of the same size
_SLOWEST, _FASTEST = 0.05, 100.0  # excitation frequency over axial resonance
_WIDEST = 0.5  # clearance


def check_press(force: float) -> None:
    """Refuse a press force in N that is not > 0.

    Raises:
        ValueError: naming the value and the rule.
    """
    if not force > 0.0:
        raise ValueError(f"press_force = {force!r}: must be > 0, or nothing presses the part")


def check_place(quantities: Mapping[str, float]) -> None:
    """Refuse quantities in SI units with which the part starts inside the hole.

    Raises:
        ValueError: the misalignment is within the play.
    """
    play = quantities["clearance"] * quantities["half_width"]
    if not quantities["misalignment"] > play:
        raise ValueError(
            f"misalignment = {quantities['misalignment']:.6g} m: already inside at the start, "
            f"misalignment <= clearance * half_width = {play:.6g} m; the clearance is the ratio "
            "(hole - peg) / peg of the radii, not a length"
        )


def doubts(quantities: Mapping[str, float], device: Device) -> list[str]:
    """Return a line for each value in SI units that is possible but probably not meant."""
    lines = [
        f"{name} = {quantities[name]:.4g} m is longer than a metre: numbers without a unit "
        f"are in metres, write {quantities[name]:.4g} mm if these are millimetres"
        for name in ("half_width", "half_height", "amplitude")
        if quantities[name] > _LONGEST
    ]
    radius = math.sqrt(quantities["inertia"] / quantities["mass"])
    size = math.hypot(quantities["half_width"], quantities["half_height"]) / math.sqrt(3.0)
    if not size / _GYRATION <= radius <= size * _GYRATION:
        lines.append(
            f"inertia and mass give a radius of gyration of {1e3 * radius:.3g} mm, a rectangle of "
            f"this size has {1e3 * size:.3g} mm"
        )
    if quantities["amplitude"] > quantities["half_width"]:
        lines.append(
            f"amplitude = {1e3 * quantities['amplitude']:.3g} mm is larger than half_width = "
            f"{1e3 * quantities['half_width']:.3g} mm"
        )
    if quantities["misalignment"] > quantities["half_width"]:
        lines.append(
            f"misalignment = {1e3 * quantities['misalignment']:.3g} mm is larger than half_width = "
            f"{1e3 * quantities['half_width']:.3g} mm: the axis of the part is beside the hole"
        )
    if quantities["clearance"] > _WIDEST:
        lines.append(
            f"clearance = {quantities['clearance']:.3g}: the hole is "
            f"{1.0 + quantities['clearance']:.3g} times as wide as the part"
        )
    if quantities["friction"] > 1.0:
        lines.append(f"friction = {quantities['friction']:.3g} is more than 1")
    return [*lines, *_doubtful_excitation(quantities, device)]


def _doubtful_excitation(quantities: Mapping[str, float], device: Device) -> list[str]:
    resonance = 1.0 / (2.0 * math.pi * device.units.time)
    frequency = quantities["frequency"]
    lines = []
    if 0.0 < frequency < _SLOWEST * resonance or frequency > _FASTEST * resonance:
        lines.append(
            f"frequency = {frequency:.4g} Hz, while mass and axial_stiffness have their resonance "
            f"at {resonance:.3g} Hz"
        )
    excitation = device.units.force
    if not 1e-3 * excitation <= quantities["press_force"] <= 1e3 * excitation:
        lines.append(
            f"press_force = {quantities['press_force']:.4g} N, while the excitation has an "
            f"amplitude of {excitation:.3g} N (axial_stiffness times amplitude)"
        )
    return lines
