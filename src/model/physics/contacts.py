"""The kinds of contact: depth, closing rate, slip, and force rows.

1. edge on the bottom face: A1 from the start, A2 after the part has jumped over the slot; of a
   round part the tips of the crescent by which its face covers the base, on the same side;
2. A2 on the left side face; in the insertion scene also A1 on the right one;
3. a bottom corner on the flat base: B1 right of the slot, B2 left of it;
4. a bottom corner on the slot's wall, in the insertion scene: B1 on the right, B2 on the left one.

A row (x, y, moment) is the direction of a contact force in the coordinates (x, y, φ): the force
times the row is the generalized force, and the row times (ẋ, ẏ, φ̇) the velocity of the touching
point along the force (virtual work). In printed variants rows of forces differ from ``slip_row``.
"""

from typing import NamedTuple

from model.compile.kernels import inlined_kernel, operation
from model.physics.geometry import bottom_corner, crescent, edge_place, face_coordinate
from model.physics.notation import LEFT_EDGE
from model.physics.trigonometry import sine_cosine, square_root

Row = tuple[float, float, float]


class Contact(NamedTuple):
    """One contact at one instant.

    Attributes:
        depth: penetration of the base, positive inside.
        closing_rate: d depth / dτ.
        along: coordinate of the base's touching point along the tangent, relative to the part.
        slip: velocity of the part's touching point along the tangent, -d along / dτ.
        slip_drift: d slip / dτ at zero accelerations.
        normal: row of the normal force n.
        tangent: row of the friction force T.
        slip_row: d slip / d(ẋ, ẏ, φ̇); equals ``tangent`` except in printed variants.
    """

    depth: float
    closing_rate: float
    along: float
    slip: float
    slip_drift: float
    normal: Row
    tangent: Row
    slip_row: Row


@inlined_kernel
def dot(row, x, y, moment):
    """Return the product of a row and a triple."""
    return row[0] * x + row[1] * y + row[2] * moment


@operation
def edge_on_face(side, q, p):
    """Return the contact of edge A1 (``side`` = +1) or A2 (-1) with the bottom face in state ``q``.

    Depth d = b + r·e_n, force n e_n + T e_t, torque s n + (b - d) T: equation (3), with the arms of
    R9 and the sign of U1 of R1.
    """
    place = edge_place(side, q.x, q.y, q.tilt, p)
    c, s = place.cos, place.sin
    along = q.x_rate * c + q.y_rate * s
    across = -q.x_rate * s + q.y_rate * c
    depth = p.half_height + place.along_axis
    closing_rate = -(across + q.tilt_rate * place.along_face)
    slip_row = (c, s, -place.along_axis)
    slip = along - q.tilt_rate * place.along_axis
    drift = q.tilt_rate * (across - closing_rate)
    normal_arm, tangent_arm = place.along_face, -place.along_axis
    if p.printed_moment_arms != 0.0:
        normal_arm, tangent_arm = face_coordinate(side, q.x, q.tilt, p), p.half_height
    x_sign = -1.0 if p.printed_normal_sign != 0.0 else 1.0
    normal = (-x_sign * s, c, normal_arm)
    tangent = (x_sign * c, s, tangent_arm)
    return Contact(depth, closing_rate, place.along_face, slip, drift, normal, tangent, slip_row)


@operation
def tips_on_face(side, q, p):
    """Return the contact of a round part's face with the tips over A1 (``side`` = +1) or A2 (-1).

    The load is the sum of the normal forces at both tips, along the common normal of the rims (T2);
    slip and its drift as (T3) and (T4). Of the tips over A2 this is the mirror image.
    """
    x, y, x_rate, tilt_rate = side * q.x, q.y, side * q.x_rate, side * q.tilt_rate
    sine, c = sine_cosine(q.tilt)
    s = side * sine
    offset, rim_x, reach, behind = crescent(x, y, s, c, p)
    a, hole = p.half_width, p.slot_half_width
    rise, along = rim_x * s, rim_x * c - offset
    square = offset * offset
    to_normal = 1.0 / square_root(square + (hole * hole) * (s * s))
    to_tangent = 1.0 / square_root(square + rise * rise)
    depth = behind * reach * to_normal
    bent = (a * a) * (s * offset) * behind * (to_normal * to_normal) / reach

    normal_x, normal_y = -rise - bent * (s * c), offset - bent * (s * s)
    moment = (along + bent) * x
    normal = (side * normal_x * to_normal, normal_y * to_normal, side * moment * to_normal)
    closing_rate = -dot(normal, q.x_rate, q.y_rate, q.tilt_rate)

    lever, moment = rim_x - x, (rim_x - x) * rise + y * offset
    slip_row = (offset * to_tangent, side * rise * to_tangent, moment * to_tangent)
    slip = dot(slip_row, q.x_rate, q.y_rate, q.tilt_rate)
    u_x, u_y = x_rate + tilt_rate * y, q.y_rate + tilt_rate * lever
    along_face = c * u_x + s * u_y
    offset_rate, rim_rate = along_face - tilt_rate * rise, -along * along_face / reach
    rise_rate = rim_rate * s + tilt_rate * rim_x * c
    turning = tilt_rate * (offset * q.y_rate + rise * (rim_rate - x_rate))
    stretching = (offset * offset_rate + rise * rise_rate) * to_tangent
    drift = offset_rate * u_x + rise_rate * u_y + turning - side * slip * stretching
    drift = side * drift * to_tangent
    return Contact(depth, closing_rate, side * along, slip, drift, normal, slip_row, slip_row)


@inlined_kernel
def support_on_face(side, q, p):
    """Return the contact of the bottom face with the base on one side: an edge, or tips."""
    return tips_on_face(side, q, p) if p.is_round else edge_on_face(side, q, p)


@operation
def edge_on_side(edge, q, p):
    """Return the contact of A2 with the left side face, or of A1 with the right one.

    Depth s + a at A2 and a - s at A1, force ±(n e_t + T e_n), + at A2, torque r × F. Only A2 has
    printed variants: the depth D2 (R4), and the force as it enters (3) at A1, with A2's q (R5).
    """
    place = edge_place(edge, q.x, q.y, q.tilt, p)
    c, s = place.cos, place.sin
    along = q.x_rate * c + q.y_rate * s
    across = -q.x_rate * s + q.y_rate * c
    depth = -edge * place.along_face + p.half_width
    closing_rate = -edge * (q.tilt_rate * place.along_axis - along)
    if p.printed_side_gap != 0.0 and edge == LEFT_EDGE:
        corner_x, corner_y = bottom_corner(LEFT_EDGE, q.x, q.y, q.tilt, p)
        gap = corner_x + p.slot_half_width - corner_y
        gap_rate = q.x_rate - q.y_rate - q.tilt_rate * (corner_y - q.y + corner_x - q.x)
        depth, closing_rate = -gap * c, gap * s * q.tilt_rate - gap_rate * c
    if p.printed_side_force != 0.0 and edge == LEFT_EDGE:
        # The tangent, too, is then the bottom face's, so that friction opposes its own slip.
        as_face = edge_on_face(LEFT_EDGE, q, p)
        x_sign = -1.0 if p.printed_normal_sign != 0.0 else 1.0
        normal = (-x_sign * s, c, face_coordinate(LEFT_EDGE, q.x, q.tilt, p))
        tangent = (x_sign * c, s, p.half_height)
        return Contact(
            depth, closing_rate, as_face.along, as_face.slip, as_face.slip_drift, normal, tangent,
            as_face.slip_row,
        )  # fmt: skip
    normal = (-edge * c, -edge * s, edge * place.along_axis)
    tangent = (edge * s, -edge * c, -edge * place.along_face)
    slip = -edge * (across + q.tilt_rate * place.along_face)
    true_closing_rate = q.tilt_rate * place.along_axis - along
    drift = -edge * (q.tilt_rate * (true_closing_rate - along))
    away = -edge * place.along_axis
    return Contact(depth, closing_rate, away, slip, drift, normal, tangent, tangent)


@operation
def corner_on_flat(side, q, p):
    """Return the contact of corner B1 (``side`` = +1) or B2 (-1) with the flat base in state ``q``.

    Depth -Y_B, force n (0, 1) + T (1, 0).
    """
    corner_x, corner_y = bottom_corner(side, q.x, q.y, q.tilt, p)
    r_x, r_y = corner_x - q.x, corner_y - q.y
    normal = (0.0, 1.0, r_x)
    tangent = (1.0, 0.0, -r_y)
    closing_rate = -(q.y_rate + q.tilt_rate * r_x)
    slip = q.x_rate - q.tilt_rate * r_y
    drift = -q.tilt_rate * q.tilt_rate * r_x
    return Contact(-corner_y, closing_rate, -corner_x, slip, drift, normal, tangent, tangent)


@operation
def corner_on_wall(side, q, p):
    """Return the contact of corner B1 (``side`` = +1) or B2 (-1) with the slot's wall on that side.

    Depth ±X_B - l, force ∓(n (1, 0) + T (0, 1)), torque r × F; the slip has the sign of that of
    ``edge_on_side`` at the edge above the corner.
    """
    corner_x, corner_y = bottom_corner(side, q.x, q.y, q.tilt, p)
    r_x, r_y = corner_x - q.x, corner_y - q.y
    normal = (-side, 0.0, side * r_y)
    tangent = (0.0, -side, -side * r_x)
    closing_rate = side * (q.x_rate - q.tilt_rate * r_y)
    slip = -side * (q.y_rate + q.tilt_rate * r_x)
    drift = side * q.tilt_rate * q.tilt_rate * r_y
    depth = side * corner_x - p.slot_half_width
    return Contact(depth, closing_rate, side * corner_y, slip, drift, normal, tangent, tangent)


@inlined_kernel
def contact_load(depth, closing_rate, q, p):
    """Return the normal force k_a d + h_a ḋ, or as printed k_a d - h_a √(ẋ² + ẏ²) (R3).

    It is not clamped: where it is negative, the base would have to pull.
    """
    if p.printed_contact_damping_law != 0.0:
        speed = square_root(q.x_rate * q.x_rate + q.y_rate * q.y_rate)
        return p.contact_stiffness * depth - p.contact_damping * speed
    return p.contact_stiffness * depth + p.contact_damping * closing_rate
