"""The comparison of costs: devices that tilt as round parts, and rows of the table."""

import numpy as np
import pytest

from benchmarks.shapes import Cost, costs, devices, line
from model.physics.geometry import farthest_tilted
from model.physics.parameters import RoundConstants
from model.physics.variants import Variants


def test_the_press_tilts_every_device_as_a_round_part():
    batch = devices(50)
    for row in batch.constants(Variants.consistent()):
        p = RoundConstants(*row.tolist())
        assert p.misalignment < farthest_tilted(p)


def test_both_shapes_are_run_and_differ():
    found = costs(devices(4), horizon=5.0, rounds=1)
    assert set(found) == {"square", "round"}
    for each in found.values():
        assert (each.steps > 0.0).all()
        assert (each.seconds < np.inf).all()
    assert (found["square"].steps != found["round"].steps).any()


def test_a_row_tells_the_ratios():
    aligns = np.ones(3, dtype=np.bool_)
    square = Cost(np.array([1.0, 2.0, 4.0]), np.array([10.0, 20.0, 40.0]), aligns)
    dear = Cost(np.array([2.0, 4.0, 2.0]), np.array([10.0, 20.0, 80.0]), aligns)
    words = line("all", dear, square, aligns).split()
    assert words[:2] == ["all", "3"]
    numbers = [float(word) for word in words[3:] if word != "to"]
    # median, quantiles at 10 and 90 %, total; median of the steps, and of the time per step
    assert numbers == pytest.approx([2.0, 0.8, 2.0, 1.14, 1.0, 2.0])
