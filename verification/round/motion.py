"""Motion of the cylinder in six degrees of freedom: suspension, excitation, contact, friction.

Friction is Coulomb's law at every place of contact, with μ n tanh(v / ε) for a slip v: a contact
that would stick creeps, in proportion to ε. Runs with falling ε tell the limit. Steps are those of
position Verlet: half a step of the pose, the velocities, half a step of the pose.
"""

import cmath
import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from verification.round.contact import FIELDS, HOLE, PEG, depths, kernel, places, point

Floats = NDArray[np.float64]
Shape = tuple[float, float, float]

RUNS_ON, ALIGNED, OUT_OF_RANGE = 0, 1, 2
MOST = 16  # places of contact at once
CLEAR = 90  # points of a rim that are looked at for the end of a run
LOOK = 8  # steps between two looks
ROWS = 1000  # of a track


class Device(NamedTuple):
    """Numbers of a device in SI units; stiffness and damping are (lateral, axial, tilt)."""

    mass: float
    inertia: float  # about a transverse axis
    spin: float  # about the peg's axis
    stiffness: tuple[float, float, float]
    damping: tuple[float, float, float]
    press: float
    amplitude: float
    frequency: float  # rad/s
    phase: float
    friction: float
    contact_stiffness: float
    contact_damping: float
    lack: float  # by which the press falls short as a run begins, N
    press_rate: float  # at which it grows, N/s


class Run(NamedTuple):
    """Run until alignment or to its horizon, with its largest forces."""

    code: int  # RUNS_ON, ALIGNED or OUT_OF_RANGE
    time: float  # of its end, from the first touch, s
    tip: float  # normal force at one tip, or where there is no tip at one place, N
    plane: float  # resultant of the normal forces in that plane, N
    track: Floats  # rows: time, centre of mass (3), rotation vector (3), energy, normal force


@kernel
def turned(r, w, time):
    """Return the rotation ``r`` after turning with the angular velocity ``w`` for a time."""
    rate = math.sqrt((w * w).sum())
    out = r.copy()
    if rate > 0.0:
        k, sin, cos = w / rate, math.sin(rate * time), math.cos(rate * time)
        for j in range(3):
            column = r[:, j].copy()
            out[:, j] = cos * column + sin * np.cross(k, column)
            out[:, j] += (1.0 - cos) * (k * column).sum() * k
    return out


@kernel
def rotation_vector(r):
    """Return the rotation vector of ``r``."""
    v = 0.5 * np.array((r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]))
    sin, cos = math.sqrt((v * v).sum()), 0.5 * (r[0, 0] + r[1, 1] + r[2, 2] - 1.0)
    return v if sin < 1e-14 else v * (math.atan2(sin, cos) / sin)


@kernel
def press(c, r, v, w, shape, device, epsilon, found, force, torque):
    """Add the contact forces; return (at one place, in the plane, in all, potential energy).

    The first three are the largest normal force at one place (at a tip that of both rims), the
    length of the resultant of all in the plane z = 0, and their sum.
    """
    one = across = up = total = energy = 0.0
    for i in range(places(c, r, shape, found)):
        at, normal, depth, share = found[i, 0:3], found[i, 3:6], found[i, 6], found[i, 7]
        arm = at - c
        slip = v + np.cross(w, arm)
        leaving = (slip * normal).sum()
        load = share * (device.contact_stiffness * depth - device.contact_damping * leaving)
        energy += 0.5 * share * device.contact_stiffness * depth * depth
        if load <= 0.0:
            continue
        slip -= leaving * normal
        speed = math.sqrt((slip * slip).sum()) + 1e-300
        f = load * (normal - device.friction * math.tanh(speed / epsilon) / speed * slip)
        force += f
        torque += np.cross(arm, f)
        total += load
        across += load * normal[0]
        up += load * normal[1]
        one = max(one, load if share == 1.0 else 2.0 * load)
    return one, math.sqrt(across * across + up * up), total, energy


@kernel
def is_in(c, r, shape):
    """Return whether the rim has left the raised side of the face, and the other has dipped in.

    In the plane of symmetry: s >= a at A1, with B2 below the base and inside the hole.
    """
    low = np.array((0.0, 1.0, 0.0))
    for i in range(CLEAR):
        x, y, z = point(PEG, i * 2.0 * math.pi / CLEAR, c, r, shape)
        if y < low[1]:
            low = np.array((x, y, z))
    if low[1] >= 0.0 or math.hypot(low[0], low[2]) > shape[2]:
        return False
    uphill = r[1, 0] * r[:, 0] + r[1, 2] * r[:, 2]
    for i in range(CLEAR):
        angle = i * 2.0 * math.pi / CLEAR
        x, y, z = point(HOLE, angle, c, r, shape)
        raised = uphill[0] * (x - c[0]) + uphill[1] * (y - c[1]) + uphill[2] * (z - c[2])
        if raised > 0.0 and depths(HOLE, angle, c, r, shape)[1] > 0.0:
            return False
    return True


@kernel
def advance(c, r, v, rest, shape, device, epsilon, step, steps, every, track):
    """Move the peg, which does not turn, until it is aligned; return a ``Run`` without its track.

    Its times count from the first touch. ``c``, ``r`` and the velocity ``v`` are changed.
    """
    found, w, touch = np.empty((MOST, FIELDS)), np.zeros(3), -1.0
    lateral, axial, tilting = device.stiffness
    k = np.array((lateral, axial, lateral))
    h = np.array((device.damping[0], device.damping[1], device.damping[0]))
    tip = plane = 0.0
    for i in range(steps):
        c += 0.5 * step * v
        r = turned(r, w, 0.5 * step)
        time, lift, turn, axis = (i + 0.5) * step, c - rest, rotation_vector(r), r[:, 1].copy()
        force, torque = -k * lift - h * v, -tilting * turn - device.damping[2] * w
        shake = device.amplitude * math.sin(device.frequency * time + device.phase)
        force[1] -= axial * shake + device.press - max(device.lack - device.press_rate * time, 0.0)
        one, resultant, total, energy = press(
            c, r, v, w, shape, device, epsilon, found, force, torque
        )
        tip, plane = max(tip, one), max(plane, resultant)
        if touch < 0.0 and total > 0.0:
            touch = time
        more = device.spin - device.inertia
        torque -= np.cross(w, more * (w * axis).sum() * axis)
        before, turning = v.copy(), w.copy()
        v += step / device.mass * force
        about = (torque * axis).sum() * axis
        w += step * ((torque - about) / device.inertia + about / device.spin)
        if i % every == 0:
            before, turning = 0.5 * (before + v), 0.5 * (turning + w)
            energy += 0.5 * ((k * lift * lift).sum() + tilting * (turn * turn).sum())
            energy += device.press * lift[1] + 0.5 * device.mass * (before * before).sum()
            energy += 0.5 * device.inertia * (turning * turning).sum()
            row = track[i // every]
            row[0], row[1:4], row[4:7] = time, c, turn
            row[7], row[8] = energy + 0.5 * more * (turning * axis).sum() ** 2, total
        c += 0.5 * step * v
        r = turned(r, w, 0.5 * step)
        if i % LOOK == 0:
            if is_in(c, r, shape):
                return ALIGNED, (i + 1) * step - max(touch, 0.0), tip, plane
            if r[1, 1] < 0.3:
                return OUT_OF_RANGE, (i + 1) * step - max(touch, 0.0), tip, plane
    return RUNS_ON, steps * step - max(touch, 0.0), tip, plane


def device_of(q: Mapping[str, float], phase: float = 0.0) -> tuple[Device, Shape]:
    """Return a device and (a, b, l) from its quantities in SI units, by the package's names."""
    a = q["half_width"]
    spin = max(0.5 * q["mass"] * a * a, 0.05 * q["inertia"])
    device = Device(
        q["mass"], q["inertia"], spin,
        (q["lateral_stiffness"], q["axial_stiffness"], q["tilt_stiffness"]),
        (q["lateral_damping"], q["axial_damping"], q["tilt_damping"]),
        q["press_force"], q["amplitude"], 2.0 * math.pi * q["frequency"], phase, q["friction"],
        q["contact_stiffness"], q["contact_damping"], 0.0, 0.0,
    )  # fmt: skip
    return device, (a, q["half_height"], a * (1.0 + q["clearance"]))


def touching(x: float, r: Floats, shape: Shape) -> Floats:
    """Return the centre of mass of a peg that just touches the base, by bisection of its height."""
    found = np.empty((MOST, FIELDS))
    low, high = shape[1] - 2.0 * shape[0], shape[1] + 2.0 * shape[0]
    for _ in range(60):
        y = 0.5 * (low + high)
        touches = places(np.array((x, y, 0.0)), r, shape, found) > 0
        low, high = (y, high) if touches else (low, y)
    return np.array((x, 0.5 * (low + high), 0.0))


def step_of(device: Device, shape: Shape, epsilon: float) -> float:
    """Return a step that resolves the contact and the stiffest friction, in s."""
    mobility = 1.0 / device.mass + (shape[0] ** 2 + shape[1] ** 2) / device.inertia
    contact = math.sqrt(device.contact_stiffness * mobility)
    contact = max(contact, device.contact_damping * mobility)
    load = 3.0 * (device.press + device.stiffness[1] * device.amplitude)
    return min(0.1 / contact, epsilon / (device.friction * load * mobility + 1e-300))


def simulate(
    quantities: Mapping[str, float], *, epsilon: float, horizon: float, phase: float = 0.0,
    tilt: float = 1e-3,
) -> Run:  # fmt: skip
    """Return the run of a device from rest, touching the base and tilted towards the hole.

    ``epsilon`` in m/s smooths friction. With an ``approach_speed`` the peg is lowered while it
    vibrates; ``tilt`` and ``phase`` are then those of the descent.
    """
    device, shape = device_of(quantities, phase)
    step = step_of(device, shape, epsilon)
    steps = math.ceil(horizon / step)
    every = math.ceil(steps / ROWS)
    track = np.full((math.ceil(steps / every), 9), np.nan)
    x, r = quantities["misalignment"], turned(np.eye(3), np.array((0.0, 0.0, 1.0)), tilt)
    start, rest = touching(x, r, shape), np.array((x, shape[1], 0.0))
    v = np.zeros(3)
    if "approach_speed" in quantities:
        device, (start[1], v[1]) = lowered(device, quantities["approach_speed"], start[1], rest[1])
    code, time, tip, plane = advance(
        start, r, v, rest, shape, device, epsilon, step, steps, every, track
    )
    return Run(code, time, tip, plane, track[np.isfinite(track[:, 0])])


def lowered(device: Device, speed: float, height: float, rest: float) -> tuple[Device, Floats]:
    """Return a device as it is lowered while it vibrates, and height and speed of the peg.

    It hangs in its steady descent so high over ``height``, at which it touches, that it swings
    clear; ``rest`` is the height at which the axial spring is relaxed.
    """
    k, h, nu = device.stiffness[1], device.damping[1], device.frequency
    response = -k * device.amplitude / (k - device.mass * nu * nu + 1j * h * nu)
    swing = response * cmath.exp(1j * device.phase)
    above = height + abs(response) + 1e-3 * device.amplitude
    hanging = rest - device.press / k + h * speed / k
    lack = k * max(above - hanging, 0.0)
    begun = np.array((hanging + lack / k + swing.imag, -speed + (1j * nu * swing).imag))
    return device._replace(lack=lack, press_rate=k * speed), begun
