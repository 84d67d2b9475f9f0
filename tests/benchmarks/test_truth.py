"""The comparison with other engines: its checks of agreement, and MuJoCo's scene.

The engines themselves are not in this environment; `make truth` runs them.
"""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from benchmarks.truth import (
    Outside,
    Sets,
    _left_corner_is_in,
    _scene,
    explain,
    judge,
    outside,
)
from vibralign import align


@pytest.fixture
def sets(device):
    return Sets([device] * 4, np.array([2.0, 4.0, 5.0, 10.0]), np.full(4, 1e-9))


def found(checks):
    return {check.what: check for check in checks}


def failing(checks):
    return [check.what for check in checks if check.holds is False]


def test_agreement_is_told_with_every_set_outside(sets):
    heyoka = sets.tau + [0.0, 5e-10, 3e-9, 0.0], np.full(4, 1e-9)
    beyond = [Outside(2, 1.5, explained=True)]
    told = found(judge(sets, heyoka, sets.tau * [1.01, 0.98, 1.5, np.nan], beyond))
    assert told["error below tau_error, heyoka"].found == "75.00 % (3 of 4)"
    assert told["error below 10 tau_error, heyoka"].holds
    assert told["MuJoCo off: median"].found == "2.00 %"
    assert told["MuJoCo off: median"].holds
    assert told["MuJoCo off by more than 20 %"].found == "1"
    assert told["MuJoCo does not align"].found == "1"
    (line,) = explain(sets, heyoka, beyond)
    assert line.startswith("    set 2: tau 5, 1.5 times the estimates 1.0e-09 + 1.0e-09")


def test_a_disagreement_in_the_median_fails(sets):
    close = sets.tau + 2e-10, np.full(4, 1e-9)
    assert failing(judge(sets, close, sets.tau * 1.04, [])) == []
    assert failing(judge(sets, close, sets.tau * 1.06, [])) == ["MuJoCo off: median"]


def test_one_set_that_is_not_explained_fails(device):
    many = Sets([device] * 1000, np.ones(1000), np.full(1000, 1e-9))
    heyoka = np.where(np.arange(1000) == 7, 1.0 + 4e-9, 1.0 + 1e-10), np.zeros(1000)
    small = [Outside(7, 4.0, explained=True)]
    assert failing(judge(many, heyoka, many.tau, small)) == []
    other = [Outside(7, 4.0, explained=False)]
    (what,) = failing(judge(many, heyoka, many.tau, other))
    assert what == "beyond it at a smaller tolerance as well"
    assert "NOT EXPLAINED" in explain(many, heyoka, other)[0]


def test_a_set_outside_is_run_again_more_accurately(device):
    right = align([device] * 2, tolerance=1e-12, cores=1)
    # As if both runs of the first set had the same error: a sharper run then explains it.
    sets = Sets([device] * 2, right.tau_align + [3e-9, 0.0], np.full(2, 1e-9))
    for shift, explained in ((0.0, True), (6e-9, False)):
        (one,) = outside(sets, (right.tau_align + [shift, 0.0], np.full(2, 1e-12)))
        assert (one.row, one.explained) == (0, explained)
        assert one.factor == pytest.approx(3.0, rel=0.01)
    assert outside(sets._replace(error=np.full(2, 1e-8)), (right.tau_align, np.zeros(2))) == []


def test_the_scene_states_the_device(device):
    world = ET.fromstring(_scene(device.replace(rest_x=0.3)))  # noqa: S314  (our own text)
    joints = {joint.get("name"): joint.attrib for joint in world.iter("joint")}
    assert float(joints["x"]["stiffness"]) == device.lateral_stiffness
    assert float(joints["x"]["springref"]) == 0.3
    assert float(joints["y"]["stiffness"]) == 1.0
    assert float(joints["y"]["springref"]) == device.half_height
    assert float(joints["tilt"]["damping"]) == device.tilt_damping
    geoms = {geom.get("type"): geom.attrib for geom in world.iter("geom")}
    assert float(geoms["sphere"]["pos"].split()[0]) == device.slot_half_width
    # A ball in a box leaves by the nearest face: the end must be farther than any depth.
    length, height, _ = (float(each) for each in geoms["box"]["size"].split())
    assert length > device.half_width + device.half_height
    assert height == device.half_height


def test_a_part_is_in_once_its_left_corner_is_in_the_slot(device):
    inside = [0.0, device.half_height - 0.1, 0.05]
    assert _left_corner_is_in(inside, device)
    assert not _left_corner_is_in([0.0, device.half_height + 0.2, 0.05], device)  # above the plane
    assert not _left_corner_is_in([-0.5, device.half_height - 0.1, 0.05], device)  # over the base
