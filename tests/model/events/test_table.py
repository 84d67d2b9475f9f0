"""Event functions: in every mode those of the independent solution, and no others."""

from itertools import product

import numpy as np
import pytest

from model.events.insertion import INSERTION
from model.events.kernels import events_of, level
from model.events.scenes import ALIGNMENT
from model.physics.modes import CLOSED, OPEN, RELEASED, SLIP_POSITIVE, START, STICKING
from model.physics.notation import LEFT_EDGE, RIGHT_EDGE, State
from verification.independent.insertion import _Insertion
from verification.independent.motion import Device
from verification.independent.motion import Mode as TheirMode
from verification.independent.printed import CRITERION, PrintedDevice, _PrintedRun
from vibralign import Batch, Settings, Variants

STATES = {"off": OPEN, "on": CLOSED, "released": RELEASED}
OUR_NAME = {
    "right enters": "right_edge_enters", "left enters": "left_edge_enters",
    "face far": "face_far_end", "slip": "support_slip", "inside": "corners_inside",
    "right lands": "right_corner_lands", "left lands": "left_corner_lands",
    "right_wall touches": "right_corner_touches", "left_wall touches": "left_corner_touches",
}  # fmt: skip


def on_the_base():
    """(our mode, theirs) with every state of edge, corner and side, sliding and sticking."""
    for edge, face, corner, side, slides in product(
        (RIGHT_EDGE, LEFT_EDGE), STATES, STATES, STATES, (STICKING, SLIP_POSITIVE)
    ):
        if face == corner == "on":
            continue  # they share the friction, by loads that no state here is made for
        offset = 0.01 * (corner != "off")
        at_corner = corner == "on" and face != "on"
        ours = START._replace(
            edge=edge, face=STATES[face], corner=STATES[corner], corner_offset=offset,
            slip_at_corner=at_corner, support_slip=slides, side=STATES[side], side_slip=slides,
        )  # fmt: skip
        yield ours, TheirMode(
            edge=edge, face=face, corner=corner, offset=offset, slip_at_corner=at_corner,
            slides=slides, side=side, side_slides=slides,
        )  # fmt: skip


def in_the_slot():
    """(our mode, theirs) with every state of the contacts on both sides of the slot.

    Slips on the right count the other way round there.
    """
    for right, wall, side, left_wall in product(STATES, repeat=4):
        at = {"slip_at_corner": wall == "on" != right, "slip_at_wall": left_wall == "on" != side}
        ours = START._replace(
            face=STATES[right], corner=STATES[wall], side=STATES[side], wall=STATES[left_wall],
            in_slot=right != "off" or wall != "off", dropped=True, support_slip=SLIP_POSITIVE,
            side_slip=SLIP_POSITIVE, **at,
        )  # fmt: skip
        yield ours, TheirMode(
            face="off", right_side=right, right_wall=wall, side=side, left_wall=left_wall,
            dropped=True, slides=-1, side_slides=1, **at,
        )  # fmt: skip


def flown_in():
    """A part that has fallen in and does not count as aligned yet: the printed criterion."""
    yield START._replace(face=OPEN, dropped=True), TheirMode(face="off", dropped=True)


def places(count, seed=1):
    """States all around the slot and over it, up to upside down."""
    low, high = [-3.0, -0.5, -1.7, -2.0, -2.0, -1.0], [3.0, 5.0, 1.7, 2.0, 2.0, 1.0]
    return [State(*y) for y in np.random.default_rng(seed).uniform(low, high, (count, 6)).tolist()]


CASES = {
    "on the base": (ALIGNMENT, on_the_base, ()),
    "as printed": (ALIGNMENT, flown_in, (CRITERION,)),
    "friction as printed": (ALIGNMENT, on_the_base, ("friction_law",)),
    "in the slot": (INSERTION, in_the_slot, ()),
}


@pytest.fixture(params=CASES.values(), ids=list(CASES))
def case(request, device):
    """(events, constants, independent run, modes)."""
    scene, modes, printed = request.param
    settings = Settings(scene=scene, readings=Variants(**dict.fromkeys(printed, "printed")))
    events = events_of(scene.events)
    p = events.constants(*settings.rows(Batch.stack([device]))[0].tolist())
    run = _PrintedRun(PrintedDevice(device, printed), 1e-12)
    if scene is INSERTION:
        run = _Insertion(Device(device), 1e-12, p.insertion_depth, "simultaneous")
    return events, p, run, [*modes()]


def applying(events, p, mode):
    """(name, number) of the events that apply in a mode."""
    return [
        (each.event.name.removesuffix("_again"), each.number)
        for each in events.all
        if each.event.source.exists(p, mode)
        and any(applies(p, mode) for applies, _ in each.event.function)
    ]


def test_event_functions_are_those_of_the_independent_solution(case):
    events, p, run, modes = case
    signs = set()
    for seed, (ours, theirs) in enumerate(modes):
        functions, numbers = run.functions(theirs), dict(applying(events, p, ours))
        if events.inserts:
            numbers.pop("corners_inside", None)  # there they only record a time
        for q in places(2400 // len(modes), seed):
            found = {name: level(events, k, 0.3, q, p, ours) for name, k in numbers.items()}
            expected = {
                OUR_NAME.get(name, name.replace(" ", "_")): float(function(0.3, np.array(q)))
                for name, function in functions.items()
            }
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-9), ours
            signs |= {(name, value > 0.0) for name, value in found.items()}
    once = {name for name, positive in signs if (name, not positive) not in signs}
    assert not once, "each is met on both sides of zero"


@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_every_event_has_its_own_name(scene):
    names = [event.name for event in scene.events]
    assert len({*names}) == len(names)
