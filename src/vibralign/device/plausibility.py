"""Plausibility of a device: values that make no sense are refused, doubtful ones are named.

Every range below contains the devices of docs/ and of the study with room to spare, and excludes
each of their quantities a thousand times larger or smaller: so a wrong prefix is noticed.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence

from model.physics.geometry import farthest_tilted, lever_doubt
from model.physics.parameters import FIELDS, Shape, constants_of
from model.physics.quantities import LENGTH
from model.physics.tables import vars_of
from model.physics.units import Device
from vibralign.device.base import mass_at_edge
from vibralign.device.holder import DIRECTIONS, critical_damping, natural_frequencies
from vibralign.device.mouth import (
    CHAMFERS,
    GRIPPER_TILT,
    as_parameters,
    is_inside,
    press_to_slide,
)
from vibralign.device.spelling import in_per_cent

DISTRUSTED = "do not trust the verdict"
_LONGEST = 1.0  # m
# Moment of inertia over that of a rectangle of the same mass, m(a² + b²)/3. A solid cylinder has at
# least 0.75, a solid ellipsoid 0.6, and a gripper adds to it. Whole sizes for half ones give 1/4.
_INERTIA = 0.6, 16.0
_DENSITY = 500.0, 20e3  # mass over the volume of the part, kg/m³
_WIDEST, _NARROWEST = 0.5, 1e-4  # clearance
_SLIPPERIEST, _ROUGHEST = 0.005, 1.0  # friction
_STEEPEST = 0.5  # tilt at the start, rad
_WIDEST_TILT = 0.05  # tolerance of the gripper's tilt, rad: ten times that of a poor gripper
_SHARPEST = 1e-6  # rounding of an edge, m
_DOUBTED = 0.5  # share by which the lever of a round part may be longer
_DEADEST = 0.01  # restitution
_STIFFEST = 3e10  # contact stiffness over half_width, Pa; edges of steel on steel have some 1e9
_DAMPING = 2e-3, 5.0  # damping ratio
_MOST_DAMPED = 1.0  # a ratio as it is measured, by the ringing of the holder
_EXCITATION = 0.05, 100.0  # excitation frequency over axial resonance
_PRESS = 0.01, 100.0  # press force over the excitation's amplitude
_SLENDERNESS = 0.02, 10.0  # half_width over half_height
_PLATE = 1e-3, 1.0  # thickness of a plate over its radius
_SOFTEST = 10.0  # contact stiffness over axial stiffness
# Natural frequency over the axial one.
_NEAR_RESONANCE = 0.1  # relative distance of the excitation from a natural frequency
_FREQUENCIES = {"lateral": (0.033, 3.3), "tilt": (0.1, 8.0)}


class DeviceError(ValueError):
    """A file that states no valid device."""


class NoNeedError(DeviceError):
    """A device that needs no alignment as stated: its face, or its chamfer, starts in the hole."""


def check_press(force: float) -> None:
    """Refuse a press force in N that is not > 0."""
    if not force > 0.0:
        raise ValueError(f"press_force = {force!r}: must be > 0, or nothing presses the part")


def check_place(given: Mapping[str, float]) -> None:
    """Refuse a place in which no edge is under the face of the part.

    ``given`` are quantities in SI units, with those of ``MOUTH``.

    Raises:
        NoNeedError: the part starts inside the hole, or its chamfer meets the hole's.
        ValueError: it starts wholly beside the hole.
    """
    tilt, own = given.get(GRIPPER_TILT, 0.0), as_parameters(given)
    bare = as_parameters({name: each for name, each in given.items() if name not in CHAMFERS})
    said = f"misalignment = {1e3 * given['misalignment']:.4g} mm"
    tilted = f", tilted by {math.degrees(tilt):.3g}°" if tilt else ""
    if is_inside(bare, tilt):
        play = given["half_width"] * (1.0 + given["clearance"] - math.cos(tilt))
        raise NoNeedError(
            f"{said}: already inside at the start{tilted}: needs no alignment, misalignment <= "
            f"clearance * half_width = {1e3 * play:.4g} mm; the clearance is the ratio (hole - "
            "peg) / peg of the radii, not a length"
            + (in_per_cent(given["clearance"]) if given["clearance"] > _WIDEST else "")
        )
    if is_inside(own, tilt):
        press = press_to_slide(given)
        under = f"under press_force = {given['press_force']:.4g} N the part"
        words = f"no vibration needed, since {under} slides in along a flank of 45°"
        if not given["press_force"] > press:
            words = (
                f"{under} does not slide in along a flank of 45°, nor is vibration modelled there"
            )
        raise NoNeedError(
            f"{said}: the chamfers meet{tilted}: {words} (that takes more than {press:.3g} N)"
        )
    wide = own["half_width"] * (1.0 + own["clearance"] + math.cos(tilt))
    if given["misalignment"] >= wide:
        raise ValueError(
            f"{said}: must be smaller than half_width * (2 + clearance) = {1e3 * wide:.4g} mm, or "
            "the part touches down wholly beside the hole"
        )


def doubts(quantities: Mapping[str, float], device: Device, shape: Shape) -> list[str]:
    """Return a line for each value that is possible but probably not meant.

    Args:
        quantities: all that is stated, and the parameters computed from it, in SI units.
        device: the same device in its own units.
        shape: shape of part and hole.
    """
    found = _lengths, _sizes, _fit, _start, _excitation, _stiffnesses, _dampings
    lines = [line for each in found for line in each(quantities, device)]
    lines += [*_place(quantities, device, shape), *_base(quantities, device, shape)]
    return [*lines, *_lever(quantities, device, shape)]


def without_unit(bare: Mapping[str, tuple[float, str]], found: Sequence[str]) -> list[str]:
    """Return a line for each ``bare`` number with its SI unit whose name the doubts contain."""
    named = re.findall(r"\w+", " ".join(found))
    return [
        f"{name} is stated without a unit, so it is taken as {value:.4g} {unit}"
        for name, (value, unit) in bare.items()
        if name in named and unit != "1"
    ]


def wide_tilts(end: float) -> list[str]:
    """Return a line if the tolerance of the gripper's tilt, stated without a unit, is wide."""
    if end <= _WIDEST_TILT:
        return []
    words = f"{GRIPPER_TILT} ± {end:.4g} is ± {math.degrees(end):.4g}°, since it has no unit: write"
    return [f"{words} ± {end:.4g} deg if it is in degrees"]


def _outside(value: float, span: tuple[float, float]) -> bool:
    return not span[0] <= value <= span[1]


def _mm(quantities: Mapping[str, float], name: str) -> str:
    return f"{name} = {1e3 * quantities[name]:.3g} mm"


def _lengths(given: Mapping[str, float], _device: Device) -> Iterator[str]:
    lengths = {name for name, field in FIELDS.items() if field.quantity == LENGTH}
    for name in given:
        if name in {*lengths, "amplitude"} - {"misalignment"} and abs(given[name]) > _LONGEST:
            yield (
                f"{name} = {given[name]:.4g} m is longer than a metre: numbers without a unit "
                f"are in metres, write {given[name]:.4g} mm if these are millimetres"
            )


def _sizes(given: Mapping[str, float], _device: Device) -> Iterator[str]:
    radius = math.sqrt(given["inertia"] / given["mass"])
    size = math.hypot(given["half_width"], given["half_height"]) / math.sqrt(3.0)
    if _outside((radius / size) ** 2, _INERTIA):
        words = (
            f"inertia and mass give a radius of gyration of {1e3 * radius:.3g} mm, a rectangle "
            f"with {_mm(given, 'half_width')} and {_mm(given, 'half_height')} has "
            f"{1e3 * size:.3g} mm"
        )
        density = given["mass"] / (8.0 * given["half_width"] ** 2 * given["half_height"])
        heavy = f"mass = {given['mass']:.3g} kg is {density:.2g} kg/m³ of a box of the part's size"
        hint = ": half_width is half the width (the radius), half_height half the length"
        words = f"{heavy}; {words}" if _outside(density, _DENSITY) else words
        yield words + hint if radius < size else words
    if _outside(given["half_width"] / given["half_height"], _SLENDERNESS):
        yield f"{_mm(given, 'half_width')}, while {_mm(given, 'half_height')}"
    for name, words in (("amplitude", ""), ("misalignment", ": its axis is beside the hole")):
        if given[name] > given["half_width"]:
            yield f"{_mm(given, name)} is larger than {_mm(given, 'half_width')}{words}"


def _fit(given: Mapping[str, float], _device: Device) -> Iterator[str]:
    clearance, friction = given["clearance"], given["friction"]
    if clearance > _WIDEST:
        wide = 1.0 + clearance
        yield (
            f"clearance = {clearance:.3g}: the hole is {wide:.3g} times as wide as the part"
            f"{in_per_cent(clearance)}"
        )
    if clearance < _NARROWEST:
        play = 1e6 * clearance * given["half_width"]
        yield f"clearance = {clearance:.3g} leaves {play:.2g} µm on each side"
    if friction > _ROUGHEST:
        yield f"friction = {friction:.3g} is more than 1{in_per_cent(friction)}"
    if 0.0 < friction < _SLIPPERIEST:
        yield f"friction = {friction:.3g} is less than dry or greased surfaces have"


def _start(given: Mapping[str, float], _device: Device) -> Iterator[str]:
    for name, most in ((GRIPPER_TILT, _STEEPEST), ("phase", math.tau)):
        if abs(given.get(name, 0.0)) > most:
            yield (
                f"{name} = {given[name]:.4g} rad is {math.degrees(given[name]):.4g}°: write "
                f"{given[name]:.4g} deg if it is in degrees"
            )


def _place(given: Mapping[str, float], device: Device, shape: Shape) -> Iterator[str]:
    p = device.parameters
    down = p.half_height * math.sin(p.initial_tilt)
    farthest = (farthest_tilted(constants_of(p, shape)) + down) * device.units.amplitude
    if shape == "round" and given["misalignment"] >= farthest:
        yield (
            f"{_mm(given, 'misalignment')}: the press tilts a round part of this clearance towards "
            f"the hole from up to {1e3 * farthest:.3g} mm; farther out it stands flat"
        )


def _lever(given: Mapping[str, float], device: Device, shape: Shape) -> Iterator[str]:
    doubt = lever_doubt(constants_of(device.parameters, shape)) if shape == "round" else 0.0
    if _DOUBTED < doubt < math.inf:
        yield (
            f"soft base: at contact_stiffness = {given['contact_stiffness']:.4g} N/m, stated or "
            "assumed, the contact yields so much that the lever of the press may be "
            f"{100.0 * doubt:.0f} % longer: {DISTRUSTED}: state the measured contact_stiffness "
            f"if it is above {given['contact_stiffness'] * doubt / _DOUBTED:.3g} N/m; if it is "
            "below, the lever is longer still: widen the play, or reduce press_force or amplitude"
        )


def _excitation(given: Mapping[str, float], device: Device) -> Iterator[str]:
    resonance = 1.0 / (math.tau * device.units.time)
    if given["frequency"] and _outside(given["frequency"] / resonance, _EXCITATION):
        yield (
            f"frequency = {given['frequency']:.4g} Hz, while mass and axial_stiffness have their "
            f"resonance at {resonance:.3g} Hz"
        )
    if _outside(given["press_force"] / device.units.force, _PRESS):
        yield (
            f"press_force = {given['press_force']:.4g} N, while the excitation has an "
            f"amplitude of {device.units.force:.3g} N (axial_stiffness times amplitude)"
        )


def _stiffnesses(given: Mapping[str, float], device: Device) -> Iterator[str]:
    natural = natural_frequencies(device.parameters)
    resonance = 1.0 / (math.tau * device.units.time)
    for direction, ratio in natural.items():
        own = f"the holder's natural frequency, {direction}, of {ratio * resonance:.3g} Hz"
        if ratio and abs(device.parameters.frequency / ratio - 1.0) <= _NEAR_RESONANCE:
            yield f"frequency = {given['frequency']:.4g} Hz is within a tenth of {own}: resonance"
        if ratio and _outside(ratio, _FREQUENCIES.get(direction, (1.0, 1.0))):
            name = f"{direction}_stiffness"
            yield (
                f"{name} = {given[name]:.4g} {FIELDS[name].quantity.unit} gives a natural "
                f"frequency of {ratio * resonance:.3g} Hz, the axial one is {resonance:.3g} Hz by "
                "axial_stiffness and mass"
            )


def _dampings(given: Mapping[str, float], _device: Device) -> Iterator[str]:
    for direction in DIRECTIONS:
        name, critical = f"{direction}_damping", critical_damping(direction, given)
        instead = f"{name}_ratio"
        if given.get(instead, 0.0) > _MOST_DAMPED:
            yield f"{instead} = {given[instead]:.4g} is more than 1{in_per_cent(given[instead])}"
        elif given[name] and critical and _outside(given[name] / critical, _DAMPING):
            ratio = given[name] / critical
            unit = FIELDS[name].quantity.unit
            words = f"{name} = {given[name]:.4g} {unit} is a damping ratio of {ratio:.2g}"
            hint = f"; if {given[name]:.4g} is the ratio, write {instead}"
            yield words if instead in given else words + hint


def _base(given: Mapping[str, float], device: Device, shape: Shape) -> Iterator[str]:
    stiffness = given.get("contact_stiffness")
    if stiffness is not None:
        if stiffness < _SOFTEST * given["axial_stiffness"]:
            yield (
                f"contact_stiffness = {stiffness:.4g} N/m: the base is hardly stiffer than the "
                f"holder, axial_stiffness = {given['axial_stiffness']:.4g} N/m"
            )
        if stiffness > _STIFFEST * given["half_width"]:
            yield f"contact_stiffness = {stiffness:.4g} N/m is more than steel of this size has"
        damping = given.get("contact_damping", 0.0)
        mass = given["mass"] * mass_at_edge(vars_of(device.parameters), shape)
        ratio = damping / (2.0 * math.sqrt(stiffness * mass))
        if damping and "restitution" not in given and _outside(ratio, _DAMPING):
            yield f"contact_damping = {damping:.4g} N s/m is a damping ratio of {ratio:.2g}"
    if given.get("restitution", 1.0) < _DEADEST:
        yield f"restitution = {given['restitution']:.3g}: hardly anything bounces so little"
    radius = given.get("edge_radius", _SHARPEST)
    overlap = given["misalignment"] - given["clearance"] * given["half_width"]
    if radius < _SHARPEST:
        yield f"{_mm(given, 'edge_radius')}: sharper than edges are"
    if "edge_radius" in given and radius > overlap:
        yield (
            f"{_mm(given, 'edge_radius')}, while the part lies on the edge by at most "
            f"{1e3 * overlap:.3g} mm (misalignment - clearance * half_width): it starts on the "
            "rounding, and the model has sharp edges"
        )
    if "plate_radius" in given and _outside(
        given["plate_thickness"] / given["plate_radius"], _PLATE
    ):
        yield f"{_mm(given, 'plate_thickness')}, while {_mm(given, 'plate_radius')}"
