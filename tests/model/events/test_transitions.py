"""Transitions at events: friction states, contacts made and lost, ends of the run."""

from math import atan, cos, sin

import pytest

from model.events import kernels
from model.events.friction import decide_friction, hold_sticking
from model.events.kernels import events_of
from model.events.round_parts import with_tips
from model.events.table import (
    FACE_FAR_END,
    FACE_GAP,
    FACE_LOAD,
    FACE_RELOAD,
    LEFT_EDGE_ENTERS,
    LEFT_WALL,
    OVERTURNED,
    RIGHT_CORNER_LANDS,
    RIGHT_EDGE_ENTERS,
    RIGHT_WALL,
    SUPPORT_SLIP,
    number_of,
)
from model.events.transitions import CONTINUES
from model.physics.contacts import edge_on_face, edge_on_side
from model.physics.modes import (
    CLOSED,
    OPEN,
    RELEASED,
    SLIP_NEGATIVE,
    SLIP_POSITIVE,
    START,
    STICKING,
)
from model.physics.motion import motion
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from model.physics.parameters import RoundConstants
from vibralign import ALIGNMENT, INSERTION, PRINTED_CONTACTS, SUSPENDED, Outcome, Reason

FREE = START._replace(face=OPEN)
EVENTS = events_of(ALIGNMENT.events)
ANY = State(0.3, 5.0, 0.1, 0.0, -0.5, 0.0)


@pytest.fixture(scope="module")
def p(device, constants):
    return constants(device)


def transition(which, q, p, mode, scene=ALIGNMENT):
    """(mode, outcome, reason) after an event at τ = 0."""
    return kernels.transition(EVENTS, which, 0.0, q, p, mode, scene.declared)


def pressed(p, tilt=0.0, x=0.3, depth=0.02, **rates):
    """State with A1 ``depth`` behind the bottom face."""
    r_x = p.slot_half_width - x
    y = (p.half_height - depth - r_x * sin(tilt)) / cos(tilt)
    rest = {"x_rate": 0.0, "y_rate": 0.0, "tilt_rate": 0.0}
    return State(x, y, tilt, **{**rest, **rates})


# ----------------------------------------------------------------------------------------- friction


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_friction_coefficient_decides_between_sticking_and_sliding(p, factor):
    # At rest, sticking needs a certain ratio |T| / n: with μ just above it the part sticks, just
    # below it slides.
    q = pressed(p, tilt=0.05)
    at = motion(0.0, q, p, START)
    needed = abs(at.support_friction) / at.support_load
    rougher = p._replace(friction=needed / factor)
    mode, possible = decide_friction(0.0, q, rougher, START, True, True)
    assert possible
    assert (mode.support_slip == STICKING) == (factor < 1.0)
    if factor > 1.0:  # against the friction that sticking would need, in the direction of the drive
        assert mode.support_slip == (SLIP_POSITIVE if at.support_friction < 0.0 else SLIP_NEGATIVE)
        assert motion(0.0, q, rougher, mode).support_drive * mode.support_slip > 0.0


def test_on_a_slope_steeper_than_the_friction_angle_it_slides_down_to_the_slot(p):
    # Locked tilt, relaxed springs, pushed in as deep as f0 cos φ does: f0 on a slope of φ. Where
    # tan φ > μ it slides in -e_t.
    for tilt, expected in [(atan(0.12) + 0.02, SLIP_NEGATIVE), (atan(0.12) - 0.02, STICKING)]:
        locked = p._replace(inertia=1e12, rest_tilt=tilt, frequency=0.0, rest_x=0.3)
        q = pressed(locked, tilt=tilt, depth=p.press_force * cos(tilt) / p.contact_stiffness)
        locked = locked._replace(rest_y=q.y)
        mode, possible = decide_friction(0.0, q, locked, START, True, True)
        assert possible
        assert mode.support_slip == expected


@pytest.mark.parametrize("x_rate", [0.2, -0.2])
def test_a_slipping_contact_keeps_the_sign_of_its_slip(p, x_rate):
    mode, possible = decide_friction(0.0, pressed(p, x_rate=x_rate), p, START, False, False)
    assert possible
    assert mode.support_slip == (SLIP_POSITIVE if x_rate > 0 else SLIP_NEGATIVE)


def test_broken_sticking_slips_against_the_friction_that_was_needed(p):
    q = pressed(p, tilt=0.3)
    needed = motion(0.0, q, p, START).support_friction
    mode, outcome, _ = transition(SUPPORT_SLIP, q, p, START)
    assert outcome == CONTINUES
    assert mode.support_slip == (SLIP_NEGATIVE if needed > 0.0 else SLIP_POSITIVE)


def test_slip_that_comes_to_rest_sticks_where_friction_suffices(p):
    rough = p._replace(friction=5.0)
    mode, outcome, _ = transition(
        SUPPORT_SLIP, pressed(p, tilt=0.05), rough, START._replace(support_slip=SLIP_NEGATIVE)
    )
    assert (mode.support_slip, outcome) == (STICKING, CONTINUES)


@pytest.mark.parametrize("both", [False, True])
def test_held_sticking_removes_the_slip_by_friction_impulses(p, random_states, both):
    mode = START._replace(side=CLOSED if both else OPEN)
    for state in random_states(10):
        q = State(*state)
        held = hold_sticking(q, p, mode)
        assert held[:3] == q[:3]
        assert edge_on_face(RIGHT_EDGE, held, p).slip == pytest.approx(0.0, abs=1e-13)
        if both:
            assert edge_on_side(LEFT_EDGE, held, p).slip == pytest.approx(0.0, abs=1e-12)
        else:  # the change of momentum is along the tangent row of the contact
            row = edge_on_face(RIGHT_EDGE, q, p).tangent
            impulse = (held.x_rate - q.x_rate) / row[0]
            assert held.y_rate - q.y_rate == pytest.approx(impulse * row[1], abs=1e-12)
            turned = p.inertia * (held.tilt_rate - q.tilt_rate)
            assert turned == pytest.approx(impulse * row[2], abs=1e-11)


def test_sliding_and_open_contacts_are_not_held(p):
    assert hold_sticking(ANY, p, START._replace(support_slip=SLIP_POSITIVE)) == ANY
    assert hold_sticking(ANY, p, FREE) == ANY


# --------------------------------------------------------------------------- contacts made and lost


GAP = 0.09 * 1.0476  # of the slot on both sides of the upright part, l - a
PLACE = State(0.0, 4.1057 - 0.3, 0.0, 0.0, 0.0, 0.0)
ENTER_LEFT = PLACE._replace(x=-GAP, x_rate=-1.0)


def test_an_edge_presses_on_the_face_through_which_it_enters(p):
    mode, outcome, _ = transition(RIGHT_EDGE_ENTERS, pressed(p, depth=0.0, y_rate=-1.0), p, FREE)
    assert (mode.edge, mode.face, outcome) == (RIGHT_EDGE, CLOSED, CONTINUES)
    mode, outcome, _ = transition(LEFT_EDGE_ENTERS, ENTER_LEFT, p, FREE)
    assert (mode.face, mode.side, outcome) == (OPEN, CLOSED, CONTINUES)


@pytest.mark.parametrize("edge", [LEFT_EDGE, RIGHT_EDGE])
@pytest.mark.parametrize("deeper", [-1e-13, 0.0, 1e-13])
def test_an_edge_in_a_round_part_meets_its_side_alone(p, edge, deeper):
    # Its event is where it is as deep behind the side as behind the bottom: rounding must not
    # choose the bottom face, which rests on tips.
    table, tilt, depth = with_tips(INSERTION.events), -0.02 * edge, 1e-3
    round_part = RoundConstants(*p)
    along, axis = edge * (p.half_width - depth), depth + deeper - p.half_height
    x = edge * p.slot_half_width - along * cos(tilt) + axis * sin(tilt)
    q = State(x, -along * sin(tilt) - axis * cos(tilt), tilt, edge * 1.0, 0.0, 0.0)
    which = number_of("left_edge_enters" if edge == LEFT_EDGE else "right_edge_enters", table)
    fallen = FREE._replace(dropped=True)
    mode, outcome, _ = kernels.transition(
        events_of(table), which, 0.0, q, round_part, fallen, INSERTION.declared
    )
    right = (mode.face, mode.in_slot) if edge == RIGHT_EDGE else (mode.side, True)
    assert (*right, mode.corner, outcome) == (CLOSED, True, OPEN, CONTINUES)


@pytest.mark.parametrize(
    ("which", "scene"),
    [
        (RIGHT_EDGE_ENTERS, SUSPENDED),
        (LEFT_EDGE_ENTERS, SUSPENDED),
        (RIGHT_CORNER_LANDS, PRINTED_CONTACTS),
    ],
)
def test_a_contact_that_is_not_declared_leaves_the_scene(p, which, scene):
    q = {
        RIGHT_EDGE_ENTERS: pressed(p, depth=0.0, y_rate=-1.0),
        LEFT_EDGE_ENTERS: ENTER_LEFT,
        RIGHT_CORNER_LANDS: State(1.0, p.half_height, -0.05, 0.0, -1.0, 0.0),
    }[which]
    _, outcome, reason = transition(which, q, p, FREE, scene)
    assert (outcome, reason) == (Outcome.LEFT_SCENE, Reason.UNDECLARED_CONTACT)
    _, outcome, _ = transition(which, q, p, FREE)  # where it is declared the run goes on
    assert outcome == CONTINUES


def test_a_lost_load_releases_the_contact_until_the_gap_opens(p):
    # Leaving at speed: k_a d + h_a ḋ = 100 * 0.02 - 2 = 0 with the base still pushed in.
    q = pressed(p, y_rate=2.0)
    mode, outcome, _ = transition(FACE_LOAD, q, p, START)
    assert (mode.face, outcome) == (RELEASED, CONTINUES)
    reloaded, _, _ = transition(FACE_RELOAD, q, p, mode)
    assert reloaded.face == CLOSED
    opened, _, _ = transition(FACE_GAP, q, p, mode)
    assert opened.face == OPEN


def test_without_damping_the_load_and_the_gap_end_together(p):
    mode, _, _ = transition(
        FACE_LOAD, pressed(p, depth=1e-17), p._replace(contact_damping=0.0), START
    )
    assert mode.face == OPEN


# ----------------------------------------------------------------------------------------- the ends


@pytest.mark.parametrize(
    ("which", "q", "mode", "reason"),
    [
        # A1 through the right side
        (RIGHT_EDGE_ENTERS, PLACE._replace(x=GAP, x_rate=1.0), FREE, Reason.EDGE_ON_OTHER_FACE),
        (LEFT_EDGE_ENTERS, PLACE._replace(y=4.1057), START, Reason.BOTH_SIDES),
        (FACE_FAR_END, ANY, START, Reason.MOVED_AWAY),
        (FACE_FAR_END, ANY, START._replace(edge=LEFT_EDGE), Reason.OVERSHOT),
        (RIGHT_WALL, ANY, FREE, Reason.CORNER_ON_WALL),
        (LEFT_WALL, ANY, FREE, Reason.CORNER_ON_WALL),
        (OVERTURNED, ANY, FREE, Reason.OVERTURNED),
    ],
)
def test_leaving_the_scene_has_a_reason(p, which, q, mode, reason):
    if reason is Reason.BOTH_SIDES:
        p = p._replace(slot_half_width=0.5)  # a part that spans the slot
    _, outcome, said = transition(which, q, p, mode)
    assert (outcome, said) == (Outcome.LEFT_SCENE, reason)
