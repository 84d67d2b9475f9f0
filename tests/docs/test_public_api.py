"""The public API is what the page on it lists, and stays as it is."""

import importlib
import inspect
import re
from enum import IntEnum
from pathlib import Path
from typing import Any

import pytest

import vibralign

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "api.md"
LISTED = re.findall(r"auto(?:function|class|data):: ([\w.]+)", PAGE.read_text(encoding="utf-8"))
# Arguments of functions and classes, members of enumerations. What is new is added here; what is
# here is not taken away without the steps that the page states.
FROZEN = {
    "vibralign.simulate": "parameters settings changes",
    "vibralign.align": "batch settings cores changes",
    "vibralign.sweep": "device settings points cores axes",
    "vibralign.assess": "device settings ensemble cores vary",
    "vibralign.Settings": """
        readings shape scene start insertion_depth horizon tolerance max_evaluations may_settle
        alignment_only
    """,
    "vibralign.Trajectory": """
        tau_align tau_error tau_corners_inside outcome reason sensitive tilt_at_alignment
        tilt_max separations contact_force_max sticking_share rhs_evaluations period
        tau_inserted insertion_error edge_force_max corner_force_max side_force_max wall_force_max
        steps events parameters time state
        contact_force side_force right_force units
    """,
    "vibralign.Alignments": """
        tau_align tau_error tau_corners_inside outcome reason sensitive tilt_at_alignment
        tilt_max separations contact_force_max sticking_share rhs_evaluations period
        tau_inserted insertion_error edge_force_max corner_force_max side_force_max wall_force_max
        steps events
    """,
    "vibralign.Parameters": """
        half_width half_height clearance misalignment initial_tilt inertia lateral_stiffness
        tilt_stiffness lateral_damping axial_damping tilt_damping contact_stiffness
        contact_damping friction press_force frequency phase rest_x rest_y rest_tilt
        approach_speed
    """,
    "vibralign.Batch": "values",
    "vibralign.baseline": "",
    "vibralign.load_device": "path changes needless",
    "vibralign.StatedDevice": """
        source quantities tolerances materials free limits changes vibrator sudden stated_shape
        horizon insertion_depth notes written unknown samples
    """,
    "vibralign.DoubtWarning": "",
    "vibralign.reliable_at": "device settings cores quantities",
    "vibralign.yield_of": "stated starts settings cores devices seed indices required",
    "vibralign.Yield": """
        devices going_in low high time force runs sobol_indices inside forces insertion
        confidence largest impossible on_chamfers
    """,
    "vibralign.DeviceResults": """
        values goes_in time times force tilt failing forces inside insertion impossible
        on_chamfers
    """,
    "vibralign.readable": "dataset",
    "vibralign.design": """
        device settings ensemble cores generations population seed devices
    """,
    "vibralign.Design": "tried best limits checks free tolerances",
    "vibralign.known_in_part": "device settings cores sets touch_downs_tried seed",
    "vibralign.covering": "device settings cores tell count sets",
    "vibralign.calibrate": """
        device trials settings cores tell target touch_downs_tried seed
    """,
    "vibralign.Calibration": "device trials samples times horizon fit notes seconds",
    "vibralign.Variants": """
        normal_sign friction_law contact_damping_law side_gap side_force preload
        alignment_criterion moment_arms
    """,
    "vibralign.Scene": "name contacts events",
    "vibralign.Outcome": """
        ALIGNED SETTLED LEFT_SCENE HORIZON_REACHED FAILED INSERTED JAMMED CLIMBED_OUT
    """,
    "vibralign.Reason": """
        NONE MOVED_AWAY OVERSHOT CORNER_ON_WALL EDGE_ON_OTHER_FACE BOTH_SIDES OVERTURNED
        UNDECLARED_CONTACT IMPOSSIBLE_START STEP_TOO_SMALL TOO_MANY_EVALUATIONS CHATTER
        NOT_FINITE NO_FRICTION_SOLUTION CHAOTIC NO_REST WEDGED LACK_OF_FORCE ON_EDGE
        BY_PRESS NO_TOUCH STILL_MOVES ON_FLANK
    """,
}


def public(name: str) -> Any:
    module, _, last = name.rpartition(".")
    return getattr(importlib.import_module(module), last)


def test_the_page_lists_what_the_package_exports():
    listed = {name.rpartition(".")[2] for name in LISTED if name.count(".") == 1}
    assert listed == set(vibralign.__all__) - {"Readings"}
    assert vibralign.Readings is vibralign.Variants
    data = {name for name in LISTED if isinstance(public(name), vibralign.Scene)}
    assert set(LISTED) - data == set(FROZEN)


@pytest.mark.parametrize("name", FROZEN)
def test_names_and_arguments_are_frozen(name):
    it = public(name)
    if isinstance(it, type) and issubclass(it, IntEnum):
        found = [member.name for member in it]
    elif isinstance(it, type) and issubclass(it, Warning):
        found = []
    else:
        found = [*inspect.signature(it).parameters]
    assert found == FROZEN[name].split()
