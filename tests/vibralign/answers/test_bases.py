"""The base from materials and restitution, against formulae, integration and the model itself."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vibralign import Settings, simulate
from vibralign.device import load_device
from vibralign.device.base import (
    MATERIALS,
    damping_ratio_of,
    hertz_stiffness,
    pair_of,
    plate_stiffness,
    restitution_of,
)

EXAMPLE = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
STEEL = MATERIALS["steel"]


def test_hertz_stiffness_is_the_slope_of_the_law():
    radius, modulus = 1e-3, 210e9 / (2.0 * (1.0 - 0.3**2))

    def force(depth):
        return 4.0 / 3.0 * modulus * math.sqrt(radius) * depth**1.5

    depth, step = 2e-6, 1e-10
    slope = (force(depth + step) - force(depth - step)) / (2.0 * step)
    found = hertz_stiffness((STEEL, STEEL), radius, force(depth))
    assert found == pytest.approx(slope, rel=1e-6)


def test_a_plate_is_as_stiff_as_the_handbook_says():
    # w = 0.217 P c² / (E t³) at ν = 0.3: Roark's table 11.2, case 17, with a clamped rim
    stiffness = plate_stiffness(STEEL, 3e-3, 30e-3)
    assert stiffness == pytest.approx(210e9 * 3e-3**3 / (0.217 * 30e-3**2), rel=2e-3)


@pytest.mark.parametrize("ratio", [0.05, 0.3, 0.8, 1.0, 1.5])
def test_restitution_is_that_of_an_integrated_impact(ratio):
    def motion(_, state):
        depth, rate = state
        return [rate, -depth - 2.0 * ratio * rate]

    def force(time, state):
        return state[0] + 2.0 * ratio * state[1] if time > 0.0 else 1.0

    force.terminal, force.direction = True, -1.0
    run = solve_ivp(motion, (0.0, 20.0), [0.0, 1.0], events=force, rtol=1e-10, atol=1e-13)
    assert restitution_of(ratio) == pytest.approx(-run.y[1, -1], rel=1e-7)
    assert damping_ratio_of(restitution_of(ratio)) == pytest.approx(ratio, rel=1e-9)


def test_restitution_is_continuous_at_critical_damping():
    below, above = (restitution_of(1.0 + step) for step in (-1e-6, 1e-6))
    assert below == pytest.approx(above, rel=1e-5)


BASE = {"edge_radius": "0.2 mm", "materials": "steel on aluminium"}


def test_materials_are_named_in_either_case_and_either_english():
    assert pair_of("Steel on Aluminum") == pair_of("steel on aluminium")
    assert pair_of("pom ON peek") == (MATERIALS["POM"], MATERIALS["PEEK"])
    assert pair_of("POM-C on PA 6.6") == (MATERIALS["POM"], MATERIALS["PA66"])
    assert pair_of("PA on PA66-GF30") == (MATERIALS["PA66"], MATERIALS["PA-GF30"])
    assert pair_of("PBT on stainless steel") == (MATERIALS["PBT"], STEEL)
    assert pair_of("PP on HDPE") == (MATERIALS["PP"], MATERIALS["PE"])


def test_materials_and_a_restitution_become_contact_parameters():
    stated = load_device(EXAMPLE, {**BASE, "restitution": 0.6})
    both = STEEL, MATERIALS["aluminium"]
    stiffness = hertz_stiffness(both, 0.2e-3, 10.0)
    assert stated.resolved({})["contact_stiffness"] == pytest.approx(stiffness)
    assert stated.base_is_stated
    plate = {"plate_thickness": "2 mm", "plate_radius": "20 mm"}
    soft = load_device(EXAMPLE, {**BASE, **plate}).resolved({})["contact_stiffness"]
    series = 1.0 / (1.0 / stiffness + 1.0 / plate_stiffness(both[1], 2e-3, 20e-3))
    assert soft == pytest.approx(series)
    # the mass at the edge: an impulse J there gives C the velocity J/M and the rate J s/I
    device = stated.quantities
    arm = device["half_width"] * (1.0 + device["clearance"]) - device["misalignment"]
    mass = 1.0 / (1.0 / device["mass"] + arm**2 / device["inertia"])
    damping = 2.0 * damping_ratio_of(0.6) * math.sqrt(stiffness * mass)
    assert stated.resolved({})["contact_damping"] == pytest.approx(damping)


def test_a_stiffer_base_of_the_same_restitution_hops_alike():
    hops = []
    for ratio in (1e4, 1e6):
        stated = load_device(
            EXAMPLE, {"contact_stiffness": 3e3 * ratio, "restitution": 0.5, "press_force": "2 N"}
        )
        run = simulate(stated.device.parameters, Settings(tolerance=1e-8, horizon=60.0))
        closed = run.contact_force > 0.0
        lifted = np.flatnonzero(closed[:-1] & ~closed[1:])
        landed = np.flatnonzero(~closed[:-1] & closed[1:])
        hops.append((run.time[lifted[:3]], run.time[landed[:3]]))
    assert hops[0][0].size == 3
    for soft, stiff in zip(*hops, strict=True):
        assert soft == pytest.approx(stiff, rel=0.02)
