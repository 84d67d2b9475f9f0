"""The comparison with other engines: what it says of agreement, and the scene it hands over.

The engines themselves are not in this environment; `make truth` runs them.
"""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from benchmarks.truth import Sets, _left_corner_is_in, _scene, summary


@pytest.fixture
def sets(device):
    return Sets([device] * 4, np.array([2.0, 4.0, 5.0, 10.0]), np.full(4, 1e-9))


def test_agreement_is_told_with_every_set_outside(sets):
    heyoka = sets.tau + [0.0, 5e-10, 3e-9, 0.0], np.full(4, 1e-9)
    mujoco = sets.tau * [1.01, 0.98, 1.5, np.nan]
    text = "\n".join(summary(sets, heyoka, mujoco))
    assert "sum of the error estimates: 3 of 4" in text
    assert "set 2: tau " in text
    assert "median 2.00 % of tau" in text
    assert "1 do not align" in text
    assert "within 5 % in the median: holds" in text
    assert "more than 20 %: 1 sets" in text


def test_a_disagreement_in_the_median_fails(sets):
    mujoco = sets.tau * 1.06
    assert "FAILS" in "\n".join(summary(sets, (sets.tau, np.zeros(4)), mujoco))


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
