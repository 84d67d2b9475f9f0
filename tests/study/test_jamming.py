"""Jamming over friction, clearance and tilt at entry: closed forms, and runs beside them."""

from math import acos, atan, hypot

import numpy as np
import pytest
import xarray as xr

from model.events.outcomes import Outcome
from model.physics.parameters import Parameters
from model.sweeps.sweep import merge, run
from study.config import load_study, study_path
from study.jamming import (
    depth_of_two_points,
    entered,
    in_jamming_diagram,
    jammed,
    tilt_at_depth,
    wedging_side,
)
from study.plans import sweep_of
from tests.vibralign.plots.drawn import jamming_data


@pytest.mark.parametrize("clearance", [1e-4, 0.03, 0.09])
@pytest.mark.parametrize("tilt", [0.05, 0.2, 0.5])
def test_the_depth_of_two_points_is_whitneys_for_small_tilts(tilt, clearance) -> None:
    depth = float(depth_of_two_points(np.array(tilt), clearance))
    # D = d cos φ + h sin φ to second order: h/d = δ/φ + φ/2, Whitney's c/φ but for the last term.
    # Next come terms of relative order φ²/6 of the first, and φ³/24 beside the last.
    assert depth == pytest.approx(clearance / tilt + 0.5 * tilt, rel=tilt**2 / 5.0)


@pytest.mark.parametrize("clearance", [0.01, 0.03])
@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_wedging_begins_where_the_line_of_contacts_leaves_the_cones(friction, clearance) -> None:
    # As tests/model/closed_forms/test_insertion.py derives it and finds it by runs.
    limit = atan(friction) - acos((1.0 + clearance) / hypot(1.0, friction))
    assert tilt_at_depth(friction, clearance) == pytest.approx(limit, rel=1e-12)
    assert float(depth_of_two_points(np.array(limit), clearance)) == pytest.approx(friction)


def test_a_depth_that_is_never_reached_by_two_points_has_the_steepest_tilt() -> None:
    # With h/d = 0.1 the part is nowhere as wide as the slot: cos φ + 0.1 sin φ < 1.09 for all φ.
    assert tilt_at_depth(0.1, 0.09) == pytest.approx(atan(0.1))


def test_parts_are_told_apart_by_the_limit_at_their_tilt() -> None:
    data = jamming_data()
    assert entered(data).sum() == data["outcome"].size - 1
    above = jammed(data).copy()
    above[0, 0, 0] = False  # jammed for lack of force
    above[1, 0, 3] = False  # never fell in
    assert (wedging_side(data) == above).all()


def test_runs_are_followed_into_the_slot() -> None:
    study = load_study(study_path())
    spec = study.jamming
    few = spec.model_copy(
        update={
            "clearance": spec.clearance.model_copy(update={"values": [0.09]}),
            "tilt_stiffness": spec.tilt_stiffness.model_copy(update={"count": 2}),
            "friction": spec.friction.model_copy(update={"count": 3}),
        }
    )
    sweep = sweep_of(study.model_copy(update={"jamming": few}), "jamming")
    data = merge(sweep, "Jamming", [run(sweep)])
    assert data["outcome"].dims == ("clearance", "tilt_stiffness", "friction")
    assert data.attrs["scene"] == "insertion"
    assert not (data["outcome"] == Outcome.ALIGNED).any()
    # The default depth: half of the way that f0 presses the part, at most a half-width.
    assert data["insertion_depth"].values.max() <= study.baseline.half_width


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_a_part_held_at_two_points_by_limiting_friction_is_on_the_diagrams_border(share) -> None:
    tilt, clearance, friction, a, b = 1e-4, 2e-5, 0.4, 1.5, 2.0
    depth = 2.0 * a * float(depth_of_two_points(np.array(tilt), clearance))
    # Forces of edge and wall on the upright part, friction upward; loads at its tip balance them.
    edge, wall = share * 3.0, (1.0 - share) * 3.0
    across, inward = wall - edge, friction * (edge + wall)
    moment = depth * edge + a * friction * (edge - wall)
    device = Parameters(
        half_width=a, half_height=b, clearance=clearance, friction=friction, inertia=1.0,
        lateral_stiffness=1.0, tilt_stiffness=10.0, lateral_damping=0.0, axial_damping=0.0,
        tilt_damping=0.0, frequency=0.0, press_force=inward + depth, rest_y=b,
        rest_x=across - b * tilt, rest_tilt=tilt + (moment + b * across) / 10.0,
    )  # fmt: skip
    fixed = {name: np.nan if each is None else each for name, each in device.given().items()}
    part = xr.Dataset({"tilt_at_alignment": tilt, "tau_align": 1.0}, fixed)
    sideways, turning = in_jamming_diagram(part)
    assert sideways == pytest.approx(friction * across / inward, abs=1e-3)
    # The tilt itself is neglected: it counts beside depth / 2a = 0.2.
    assert turning == pytest.approx(1.0, abs=1e-3)
