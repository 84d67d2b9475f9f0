"""Loops over lanes are compiled to vector code."""

import pytest

from model.compile import machine_code
from model.compile.entries import flattened
from model.compile.module import Module
from model.compile.vector_code import WIDTH
from model.engine import lane_events, step
from model.engine.lane_events import lane_events_of
from model.engine.workspace import new_workspace
from model.events.insertion import INSERTION
from model.events.kernels import in_kernels
from model.events.scenes import ALIGNMENT, Scene

# Kernels whose loops are all over lanes, and their arguments.
LOOPS = {
    step._set_sines: "lanes, w",
    step._set_lengths: "lanes, w",
    step._set_error_orders: "lanes, w",
    lane_events.sample_levels: "lanes, applicable, w",
    step._screen: "lanes, applicable, w",
    step._find_single: "lanes, which, w",
    step._find_combined: "lanes, which, w",
    step._end_steps: "lanes, w",
}


@pytest.mark.parametrize("kernel", LOOPS, ids=lambda kernel: kernel.__name__)
@pytest.mark.parametrize("scene", [ALIGNMENT, INSERTION], ids=lambda scene: scene.name)
def test_lanes_are_written_a_vector_at_a_time(kernel, scene: Scene):
    lanes = lane_events_of(in_kernels(scene).events)
    given = {"lanes": lanes, "applicable": 0, "which": 0, "w": new_workspace(lanes.lines)}
    types = tuple(flattened(given[name], []) for name in LOOPS[kernel].split(", "))
    module = Module((kernel, types), None)
    code = str(machine_code.optimised(module.text(), machine_code._machine(), is_finished=False))
    assert f"store <{WIDTH} x double>" in code
    assert "store double" not in code
