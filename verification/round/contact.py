"""Contact of a rigid cylinder with a hole's rim in three dimensions, by penalties at rim points.

The base is the half space Y <= 0 without the cylinder X² + Z² < l². Points of the hole's rim are
inside the peg, points of the peg's rim inside the base; each by the smaller of two depths, behind a
flat face and behind a round one. The face of the peg touches flat ground first with its rim, so
rims are enough. Nothing here knows of crescents, tips, levers or wedges: along either rim the
places of greatest depth are found numerically.

At such a place the depth is either smooth, or a ridge where both depths are equal and have slopes
of opposite sign. On a ridge the gradient of the depth with the pose is the mean of both normals,
weighted by the slope of the other: its direction is the common normal, and the depth divided by its
length the penetration along it. The force is k times that, so without damping and friction it has a
potential, to first order in the depth.
"""

import math
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

HOLE, PEG = 0, 1  # whose rim
COARSE, FINE = 24, 7  # intervals around a rim, and within one that holds a place of contact
BISECTIONS, SECANTS, CLOSE = 24, 12, 1e-9
SIDE_BY_SIDE = 0.25  # share of the stiffness at a ridge: two rims find it, on two sides
FIELDS = 8  # of a place of contact: point, normal, penetration, share of the stiffness


def kernel(function: Any) -> Any:
    """Compile a function where numba is installed; the environment of the study may lack it."""
    return import_module("numba").njit(function) if find_spec("numba") else function


@kernel
def depths(rim, angle, c, r, shape):
    """Return (flat, round, their slopes) of the point at ``angle`` of a rim; metres.

    ``c`` is the centre of mass, ``r`` the rotation, shape (3, 3), ``shape`` (a, b, l): radius of
    the peg, height of the centre of mass over its bottom face, radius of the hole.
    """
    a, b, hole = shape
    cos, sin = math.cos(angle), math.sin(angle)
    if rim == HOLE:
        x, y, z = hole * cos - c[0], -c[1], hole * sin - c[2]
        u = r[0, 0] * x + r[1, 0] * y + r[2, 0] * z
        v = r[0, 1] * x + r[1, 1] * y + r[2, 1] * z
        w = r[0, 2] * x + r[1, 2] * y + r[2, 2] * z
        du, dw = r[2, 0] * cos - r[0, 0] * sin, r[2, 2] * cos - r[0, 2] * sin
        dv = r[2, 1] * cos - r[0, 1] * sin
        radius = math.sqrt(u * u + w * w)
        return v + b, a - radius, hole * dv, -hole * (u * du + w * dw) / radius
    x, y, z = point(rim, angle, c, r, shape)
    dx, dz = a * (r[0, 2] * cos - r[0, 0] * sin), a * (r[2, 2] * cos - r[2, 0] * sin)
    dy = a * (r[1, 2] * cos - r[1, 0] * sin)
    radius = math.sqrt(x * x + z * z)
    return -y, radius - hole, -dy, (x * dx + z * dz) / radius


@kernel
def point(rim, angle, c, r, shape):
    """Return the point at ``angle`` of a rim."""
    a, b, hole = shape
    cos, sin = math.cos(angle), math.sin(angle)
    if rim == HOLE:
        return hole * cos, 0.0, hole * sin
    return (
        c[0] + r[0, 0] * a * cos - r[0, 1] * b + r[0, 2] * a * sin,
        c[1] + r[1, 0] * a * cos - r[1, 1] * b + r[1, 2] * a * sin,
        c[2] + r[2, 0] * a * cos - r[2, 1] * b + r[2, 2] * a * sin,
    )


@kernel
def normals(rim, at, c, r):
    """Return the directions (flat, round) in which the peg is pushed at a point ``at``."""
    if rim == PEG:
        radius = math.sqrt(at[0] * at[0] + at[2] * at[2])
        return np.array((0.0, 1.0, 0.0)), np.array((-at[0] / radius, 0.0, -at[2] / radius))
    axis, out = r[:, 1].copy(), np.array(at) - c
    out -= (out * axis).sum() * axis
    return axis, -out / math.sqrt((out * out).sum())


@kernel
def slope(rim, angle, c, r, shape):
    """Return (depth, slope, 1.0 if the round face is nearer) at ``angle`` of a rim."""
    flat, curved, d_flat, d_curved = depths(rim, angle, c, r, shape)
    if curved < flat:
        return curved, d_curved, 1.0
    return flat, d_flat, 0.0


@kernel
def ridge(rim, low, high, c, r, shape):
    """Return narrow bounds of the place where both depths are equal, if it is a ridge.

    Else the bounds that were given. Regula falsi, halved where one end stays (Illinois).
    """
    a, b = low, high
    flat, curved, _, _ = depths(rim, a, c, r, shape)
    at_a = flat - curved
    flat, curved, _, _ = depths(rim, b, c, r, shape)
    at_b = flat - curved
    for _ in range(SECANTS):
        middle = b - at_b * (b - a) / (at_b - at_a)
        flat, curved, _, _ = depths(rim, middle, c, r, shape)
        a, at_a = (b, at_b) if (flat - curved) * at_b < 0.0 else (a, 0.5 * at_a)
        b, at_b = middle, flat - curved
        if abs(b - a) < CLOSE or at_b == 0.0:
            break
    before, behind = b - 0.4 * CLOSE, b + 0.4 * CLOSE
    rises, still = slope(rim, before, c, r, shape)[1], slope(rim, behind, c, r, shape)[1]
    return (before, behind) if rises > 0.0 >= still else (low, high)


@kernel
def deepest(rim, low, high, c, r, shape, found, count):
    """Add the place of greatest depth between two angles to ``found``; return their number."""
    if slope(rim, low, c, r, shape)[2] != slope(rim, high, c, r, shape)[2]:
        low, high = ridge(rim, low, high, c, r, shape)
    for _ in range(BISECTIONS):
        if high - low < CLOSE:
            break
        middle = 0.5 * (low + high)
        if slope(rim, middle, c, r, shape)[1] > 0.0:
            low = middle
        else:
            high = middle
    depth, before, kind = slope(rim, low, c, r, shape)
    _, after, other = slope(rim, high, c, r, shape)
    # The hole's rim under the face alone: the face reaches further down at the peg's own rim.
    if depth <= 0.0 or count == found.shape[0] or (rim == HOLE and kind == 0.0 and other == 0.0):
        return count
    at = point(rim, low, c, r, shape)
    flat, curved = normals(rim, at, c, r)
    share, round_part = 1.0, kind
    if kind != other:
        share = SIDE_BY_SIDE
        weight = -after / (before - after)  # of the depth before the ridge
        round_part = weight if kind == 1.0 else 1.0 - weight
    normal = round_part * curved + (1.0 - round_part) * flat
    length = math.sqrt((normal * normal).sum())
    found[count, 0], found[count, 1], found[count, 2] = at
    found[count, 3:6] = normal / length
    found[count, 6], found[count, 7] = depth / length, share
    return count + 1


@kernel
def places(c, r, shape, found):
    """Write the places of contact into ``found``, shape (n, FIELDS); return their number."""
    count, step = 0, 2.0 * math.pi / COARSE
    for rim in (HOLE, PEG):
        radius = shape[2] if rim == HOLE else shape[0]
        last_depth, last_slope, _ = slope(rim, -0.5 * step, c, r, shape)
        for i in range(COARSE):
            angle = (i + 0.5) * step
            depth, rise, _ = slope(rim, angle, c, r, shape)
            if last_slope > 0.0 >= rise and max(depth, last_depth) > -step * radius:
                low, rises = angle - step, True
                for j in range(1, FINE + 1):
                    high = angle - step + j * step / FINE
                    still = slope(rim, high, c, r, shape)[1] > 0.0
                    if rises and not still:
                        count = deepest(rim, low, high, c, r, shape, found, count)
                    low, rises = high, still
            last_depth, last_slope = depth, rise
    return count
