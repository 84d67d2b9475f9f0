"""The comparison with other engines: what it says of agreement, and the scene it hands over.

The engines themselves are not in this environment; `make truth` runs them.
"""

from xml.etree import ElementTree as ET

import numpy as np
import pytest

from benchmarks.truth import Sets, _scene, summary


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
    places = [float(geom.get("pos").split()[0]) for geom in world.iter("geom") if geom.get("pos")]
    assert sorted(places) == [-device.slot_half_width, device.slot_half_width]
