"""Event functions: where each is positive, where it is zero, where it does not apply.

States are placed by hand: the part upright unless said otherwise, with the device's a = 1.0476, b =
4.1057 and slot half-width l = 1.09 a.
"""

from math import cos, sin

import numpy as np
import pytest

from model.events.event_functions import NEVER
from model.events.kernels import MOST_SAMPLES, events_of, level, sample_into
from model.events.table import EVENTS
from model.physics.contacts import contact_load, edge_on_face
from model.physics.modes import (
    CLOSED,
    OPEN,
    RELEASED,
    SLIP_NEGATIVE,
    SLIP_POSITIVE,
    START,
)
from model.physics.motion import motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from vibralign import Variants

ALL = events_of(EVENTS)
ROUNDING = 1e-13
FREE = START._replace(face=OPEN)
ON_CORNER = START._replace(face=OPEN, corner=CLOSED, slip_at_corner=True)
INDEX = {event.name.upper(): number for number, event in enumerate(EVENTS)}


@pytest.fixture(scope="module")
def p(device, constants):
    return constants(device)


@pytest.fixture(scope="module")
def sample(p):
    """Values of all event functions by name; ``changes`` alter the upright part at rest."""

    def make(mode, time=0.0, **changes):
        q = State(0.0, p.half_height + 1.0, 0.0, 0.0, 0.0, 0.0)._replace(**changes)
        out = np.empty(MOST_SAMPLES)
        sample_into(ALL, time, q, p, mode, out)
        return {name: out[index] for name, index in INDEX.items()}

    return make


def applying(sample):
    return {name for name, value in sample.items() if value != NEVER}


def test_every_event_has_its_own_number():
    assert sorted(INDEX.values()) == list(range(len(EVENTS)))


# ------------------------------------------------------------------------ event functions of a mode

FLIGHT = {
    "ALIGNED", "RIGHT_EDGE_ENTERS", "LEFT_EDGE_ENTERS", "RIGHT_CORNER_LANDS", "LEFT_CORNER_LANDS",
    "RIGHT_WALL", "LEFT_WALL", "OVERTURNED",
}  # fmt: skip
FACE = {"FACE_END", "FACE_FAR_END"}


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        (FREE, FLIGHT),
        (
            START,
            FLIGHT - {"ALIGNED", "RIGHT_EDGE_ENTERS", "RIGHT_WALL"}
            | FACE | {"FACE_LOAD", "SUPPORT_SLIP"},
        ),
        (
            START._replace(face=RELEASED),
            FLIGHT - {"ALIGNED", "RIGHT_EDGE_ENTERS", "RIGHT_WALL"}
            | FACE | {"FACE_GAP", "FACE_RELOAD"},
        ),
        (
            START._replace(edge=LEFT_EDGE),
            FLIGHT - {"LEFT_EDGE_ENTERS", "LEFT_WALL"} | FACE | {"FACE_LOAD", "SUPPORT_SLIP"},
        ),
        (
            FREE._replace(side=CLOSED),
            FLIGHT - {"LEFT_EDGE_ENTERS", "LEFT_CORNER_LANDS"}
            | {"SIDE_LOAD", "SIDE_END", "SIDE_SLIP"},
        ),
        (
            FREE._replace(side=RELEASED),
            FLIGHT - {"LEFT_EDGE_ENTERS", "LEFT_CORNER_LANDS"}
            | {"SIDE_GAP", "SIDE_RELOAD", "SIDE_END"},
        ),
        (
            ON_CORNER,
            FLIGHT - {"RIGHT_CORNER_LANDS", "RIGHT_WALL"}
            | {"CORNER_LOAD", "CORNER_END", "SUPPORT_SLIP"},
        ),
        (FREE._replace(dropped=True), FLIGHT - {"ALIGNED", "RIGHT_WALL"} | {"CORNERS_INSIDE"}),
    ],
    ids=["flight", "face", "released", "left face", "side", "side released", "corner", "dropped"],
)  # fmt: skip
def test_only_functions_of_the_mode_apply(sample, mode, expected):
    assert applying(sample(mode)) == expected


def test_one_function_alone_is_as_in_the_sample(device, constants, random_states):
    p, out, compared = constants(device), np.empty(MOST_SAMPLES), set()
    released = START._replace(face=RELEASED, side=RELEASED, corner=RELEASED)
    for mode in (FREE, START, ON_CORNER._replace(side=CLOSED), released):
        for q in (State(*y) for y in random_states(20)):
            sample_into(ALL, 0.3, q, p, mode, out)
            for which in np.flatnonzero(out[: len(EVENTS)] != NEVER).tolist():
                alone = level(ALL, which, 0.3, q, p, mode)
                assert alone == pytest.approx(out[which], rel=1e-13, abs=1e-13), which
                compared.add(which)
    assert compared == set(range(len(EVENTS))) - {INDEX["CORNERS_INSIDE"]}  # once it has dropped


def test_printed_friction_has_no_event(device, constants):
    out = np.empty(MOST_SAMPLES)
    q = State(0.2, device.half_height - 0.01, 0.0, 0.1, 0.0, 0.0)
    p = constants(device, Variants(friction_law="printed"))
    sample_into(ALL, 0.0, q, p, START._replace(support_slip=SLIP_NEGATIVE), out)
    assert out[INDEX["SUPPORT_SLIP"]] == NEVER


# ----------------------------------------------------------------------------------- levels by hand

A, B, L = 1.0476, 4.1057, 1.09 * 1.0476
GAP = L - A  # of the slot on both sides of the upright part
ON_SIDE = FREE._replace(side=CLOSED, side_slip=SLIP_POSITIVE)
LEFT_FACE = START._replace(edge=LEFT_EDGE)
BACKWARD, FORWARD = (START._replace(support_slip=sign) for sign in (SLIP_NEGATIVE, SLIP_POSITIVE))
LEVELS = [
    # The edge past the corner, the other corner in the slot, and below the plane: the last counts.
    ("ALIGNED", FREE, {"y": B - 0.01}, -0.01),
    ("ALIGNED", FREE, {"y": B - 0.01, "x": GAP + 0.02}, 0.02),
    ("ALIGNED", FREE, {"y": B - 0.01, "x": -GAP - 0.03}, 0.03),
    ("ALIGNED", FREE, {"y": B + 0.4}, 0.4),
    # The face comes down on the edge.
    ("RIGHT_EDGE_ENTERS", FREE, {"x": 0.5, "y": B + 0.3}, 0.3),
    ("RIGHT_EDGE_ENTERS", FREE, {"x": 0.5, "y": B}, 0.0),
    ("RIGHT_EDGE_ENTERS", FREE, {"x": 0.5, "y": B - 0.2}, -0.2),
    # Over the slot and below the plane the edges stand beside the part, or in its left side.
    ("RIGHT_EDGE_ENTERS", FREE, {"x": 0.04, "y": B - 0.3}, GAP - 0.04),
    ("LEFT_EDGE_ENTERS", FREE, {"x": 0.04, "y": B - 0.3}, GAP + 0.04),
    ("LEFT_EDGE_ENTERS", FREE, {"x": -GAP - 0.02, "y": B - 0.3}, -0.02),
    # The edge stands at ±l - x along the face; A2 stands y below C along the side.
    ("FACE_END", START, {"x": 0.1, "y": B}, A - L + 0.1),
    ("FACE_END", LEFT_FACE, {"x": -0.1, "y": B}, A - L + 0.1),
    ("FACE_FAR_END", START, {"x": 0.1, "y": B}, A + L - 0.1),
    ("FACE_FAR_END", LEFT_FACE, {"x": -0.1, "y": B}, A + L - 0.1),
    ("SIDE_END", ON_SIDE, {"y": B - 0.2}, 0.2),
    ("SIDE_END", ON_SIDE, {"y": -B + 0.3}, 0.3),
    ("CORNER_END", ON_CORNER, {"x": 0.3 + GAP}, 0.3),
    # A contact slides while its own slip keeps its sign.
    ("SUPPORT_SLIP", FORWARD, {"y": B - 0.01, "x_rate": 0.3}, 0.3),
    ("SUPPORT_SLIP", FORWARD, {"y": B - 0.01, "x_rate": -0.3}, -0.3),
    ("SUPPORT_SLIP", BACKWARD, {"y": B - 0.01, "x_rate": 0.3}, -0.3),
    ("SUPPORT_SLIP", BACKWARD, {"y": B - 0.01, "x_rate": -0.3}, 0.3),
    ("SIDE_SLIP", ON_SIDE, {"x": -0.1, "y": B - 0.3, "y_rate": 0.2}, 0.2),
    ("SIDE_SLIP", ON_SIDE, {"x": -0.1, "y": B - 0.3, "y_rate": -0.2}, -0.2),
]


@pytest.mark.parametrize(("name", "mode", "pose", "expected"), LEVELS)
def test_the_level_of_an_upright_part(sample, name, mode, pose, expected):
    assert sample(mode, **pose)[name] == pytest.approx(expected, abs=ROUNDING)


def test_corners_inside_are_the_papers_four_conditions(p, sample):
    mode = FREE._replace(dropped=True)
    gap = p.slot_half_width - p.half_width
    tilt = 0.02
    for x, y in [(0.0, p.half_height - 0.1), (gap, p.half_height - 0.1), (0.0, p.half_height)]:
        corners = [
            (
                x + side * p.half_width * cos(tilt) + p.half_height * sin(tilt),
                y + side * p.half_width * sin(tilt) - p.half_height * cos(tilt),
            )
            for side in (1, -1)
        ]
        (x1, y1), (x2, y2) = corners
        expected = max(x1 - p.slot_half_width, -p.slot_half_width - x2, y1, y2)
        value = sample(mode, x=x, y=y, tilt=tilt)["CORNERS_INSIDE"]
        assert value == pytest.approx(expected, abs=ROUNDING)


# ------------------------------------------------------------------------------ contacts that begin


@pytest.mark.parametrize(("side", "name"), [(1, "RIGHT"), (-1, "LEFT")])
def test_a_corner_lands_beside_the_slot_tilted_down_and_coming_down(p, sample, side, name):
    tilt = -0.05 * side
    # Where the corner stands 0.02 below the plane, 0.3 beside the slot.
    x = side * (p.slot_half_width + 0.3) - (
        side * p.half_width * cos(tilt) + p.half_height * sin(tilt)
    )
    y = -0.02 - (side * p.half_width * sin(tilt) - p.half_height * cos(tilt))

    def lands(**changes):
        pose = {"x": x, "y": y, "tilt": tilt, "y_rate": -1.0}
        return sample(FREE, **{**pose, **changes})[f"{name}_CORNER_LANDS"]

    assert lands() < 0.0
    assert lands(y_rate=1.0) > 0.0  # on its way up
    assert lands(x=x - 0.5 * side) > 0.0  # over the slot
    assert lands(y=y + 0.03) > 0.0  # above the plane
    # Tilted the other way about the same corner it is the upper corner of the face.
    assert lands(tilt=-tilt, x=x + 2 * p.half_height * sin(tilt)) > 0.0


@pytest.mark.parametrize(("side", "name"), [(1, "RIGHT"), (-1, "LEFT")])
def test_a_corner_meets_the_wall_from_inside_when_the_other_is_higher(p, sample, side, name):
    tilt = 0.05 * side  # its own corner up: it came from inside the slot, not from above
    x = side * (p.slot_half_width + 0.01) - (
        side * p.half_width * cos(tilt) + p.half_height * sin(tilt)
    )
    y = -0.3 - (side * p.half_width * sin(tilt) - p.half_height * cos(tilt))
    s = sample(FREE, x=x, y=y, tilt=tilt)
    assert s[f"{name}_WALL"] == pytest.approx(-0.01, abs=ROUNDING)
    s = sample(FREE, x=x - 0.03 * side, y=y, tilt=tilt)
    assert s[f"{name}_WALL"] == pytest.approx(0.02, abs=ROUNDING)


# -------------------------------------------------------------------------------- contacts that end


def test_load_gap_and_reload_of_the_face(p, sample, random_states):
    for x, y, tilt, dx, dy, dtilt in random_states(10):
        q = State(x, y, tilt, dx, dy, dtilt)
        face = edge_on_face(RIGHT_EDGE, q, p)
        load = contact_load(face.depth, face.closing_rate, q, p)
        closed = sample(START, **q._asdict())
        released = sample(START._replace(face=RELEASED), **q._asdict())
        assert closed["FACE_LOAD"] == load
        assert (released["FACE_GAP"], released["FACE_RELOAD"]) == (face.depth, -load)


def test_the_load_of_a_corner_counts_from_its_offset(p, sample):
    mode = ON_CORNER._replace(corner_offset=0.01)
    s = sample(mode, x=1.0, y=p.half_height - 0.03)
    assert s["CORNER_LOAD"] == pytest.approx(p.contact_stiffness * 0.02, abs=1e-11)


# ----------------------------------------------------------------------------------------- friction


def test_sticking_lasts_while_friction_stays_below_its_limit(p, sample):
    q = {"x": 0.3, "y": p.half_height - 0.01, "tilt": 0.02}
    at = motion(0.0, State(**q, x_rate=0.0, y_rate=0.0, tilt_rate=0.0), p, START)
    margin = sample(START, **q)["SUPPORT_SLIP"]
    assert margin == pytest.approx(
        p.friction * at.support_load - abs(at.support_friction), abs=1e-12
    )
    assert margin != 0.0


def test_overturned_just_below_ninety_degrees_on_both_sides(sample):
    right, left = (sample(FREE, y=100.0, tilt=tilt)["OVERTURNED"] for tilt in (1.5, -1.5))
    assert right == left
    assert 0.0 < right < 0.08
    assert sample(FREE, y=100.0, tilt=1.58)["OVERTURNED"] < 0.0
