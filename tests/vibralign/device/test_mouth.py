"""Misalignment, gripper's tilt and chamfers: the one conversion, by geometry and by runs."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from model.engine.results import RESULTS
from model.events.outcomes import Outcome, Reason
from model.physics.geometry import bottom_corner, crescent, edge_place, resting_height
from model.physics.parameters import constants_of
from vibralign import Settings, align, load_device, simulate
from vibralign.answers import yields
from vibralign.commands import main as cli
from vibralign.device.mouth import (
    as_parameters,
    is_inside,
    judged,
    judged_on_chamfers,
    press_to_slide,
    steepest,
)
from vibralign.device.plausibility import NoNeedError

PEG = Path(__file__).resolve().parents[3] / "docs" / "peg.yaml"
SUDDEN = {"approach_speed": "sudden"}
QUICK = Settings(tolerance=1e-7)


@pytest.mark.parametrize("tilt", [-0.02, 0.0, 0.0017, 0.05])
def test_the_middle_of_the_face_starts_at_the_misalignment(tilt):
    device = load_device(PEG, {"gripper_tilt": tilt, "centre_height": "30 mm"})
    p = constants_of(device.parameters, "square")
    y = resting_height(p)
    corners = [bottom_corner(side, p.misalignment, y, p.initial_tilt, p)[0] for side in (1.0, -1.0)]
    middle = 0.5 * sum(corners) * device.units.amplitude
    assert middle == pytest.approx(device.quantities["misalignment"], rel=1e-12)
    assert p.initial_tilt == p.rest_tilt == tilt
    assert p.rest_x == p.misalignment  # the springs are relaxed there


def test_a_mass_centre_may_start_on_the_other_side():
    # A pin with its centre 30 mm up, .1 mm off at the mouth, held at +.3° (start.md, 3).
    given = {"misalignment": 0.1e-3, "gripper_tilt": math.radians(0.3), "half_height": 0.03}
    found = as_parameters(given | {"half_width": 3e-3, "clearance": 0.002})
    assert found["misalignment"] == pytest.approx(-0.057e-3, abs=5e-7)


def test_a_part_runs_from_a_negative_x():
    changes = {"gripper_tilt": "1.2 deg", "misalignment": "0.3 mm", **SUDDEN}
    device = load_device(PEG, changes)
    assert device.parameters.misalignment < 0.0
    assert simulate(device, QUICK).outcome is Outcome.ALIGNED


def test_a_face_that_clears_the_hole_needs_no_alignment():
    # It met no edge, hung in the hole on its springs, and was called "settled without aligning".
    hangs = {"gripper_tilt": -0.02, "misalignment": "0.2 mm"}
    with pytest.raises(NoNeedError, match=r"already inside at the start, tilted by -1\.15°"):
        load_device(PEG, hangs)
    device = load_device(PEG, SUDDEN).changed(**hangs)  # a run that is asked for all the same
    run = simulate(device, QUICK)
    assert (run.outcome, run.tau_align) == (Outcome.ALIGNED, 0.0)
    assert align([device], QUICK).tau_align.tolist() == [0.0]
    play = 5e-3 * (1.04 - math.cos(0.02))
    for share, inside in ((0.999, True), (1.001, False)):
        given = {"misalignment": share * play, "gripper_tilt": -0.02, "half_height": 0.02}
        parameters = as_parameters(given | {"half_width": 5e-3, "clearance": 0.04})
        assert is_inside(parameters, -0.02) == inside


# -------------------------------------------------------------------------------------- chamfers


@pytest.mark.parametrize("shape", ["round", "square"])
def test_a_chamfered_pair_is_a_pair_of_face_and_mouth(shape):
    own = {"gripper_tilt": 0.003, **SUDDEN}
    chamfers = {"peg_chamfer": "0.1 mm", "hole_chamfer": "0.15 mm"}
    one = load_device(PEG, own | chamfers)
    face, mouth = 4.9e-3, 5.2e-3 + 0.15e-3
    pair = load_device(PEG, own | {"half_width": face, "clearance": mouth / face - 1.0})
    assert one.values["half_width"] == 5e-3  # as it is stated
    runs = [simulate(each, QUICK, shape=shape) for each in (one, pair)]
    assert runs[0].outcome is Outcome.ALIGNED
    for name in ("tau_align", "tilt_max", "contact_force_max", "separations"):
        assert getattr(runs[0], name) == pytest.approx(getattr(runs[1], name), rel=1e-9)


def test_the_flanks_bear_the_normal_at_the_tips_up_to_the_steepest_tilt():
    rng = np.random.default_rng(64)
    device = load_device(PEG, SUDDEN)
    for _ in range(20):
        clearance = rng.uniform(0.005, 0.2)
        parameters = device.parameters.replace(clearance=clearance)
        p, limit = constants_of(parameters, "round"), steepest({"clearance": clearance})
        for share in (0.9, 1.0, 1.1):
            s, c = math.sin(share * limit), math.cos(share * limit)
            # Aligned: A1 at the corner B1, where the tips merge: X = l, ξ = a.
            offset = p.slot_half_width * c - p.half_width
            x, y = offset * c, offset * s
            tips = crescent(x, y, s, c, p)
            assert tips.rim_x == pytest.approx(p.slot_half_width)
            place = edge_place(1.0, x, y, share * limit, p)
            assert place.along_face == pytest.approx(p.half_width)
            # The normal of (T2) is along (-X s, p, ∓Z s): across the hole's axis by l s / p.
            lean = p.slot_half_width * s / tips.offset
            assert (lean <= 1.0 + 1e-9) == (share <= 1.0)


def test_an_alignment_on_a_flank_is_not_known():
    parameters = {"half_width": 5.0, "half_height": 20.0, "clearance": 0.02, "misalignment": 0.5,
                  "initial_tilt": 0.0}  # fmt: skip
    most = float(steepest(parameters))
    results = {name: np.zeros(3) for name in RESULTS} | {"tau_align": np.array([3.0, 3.0, 3.0])}
    results["tilt_max"] = np.array([0.9 * most, 1.1 * most, 0.1 * most])
    results["side_force_max"] = np.array([0.0, 0.0, 2.0])
    found = judged(results, parameters, chamfered=True)
    assert found["tau_align"].tolist()[0] == 3.0
    assert np.isnan(found["tau_align"][1:]).all()
    assert found["reason"].tolist() == [0, Reason.ON_FLANK, Reason.ON_FLANK]
    kept = judged(results, parameters, chamfered=False)
    assert kept["tau_align"].tolist() == [3.0, 3.0, 3.0]


def test_a_slide_along_a_flank_balances_press_friction_and_springs():
    given = load_device(PEG, SUDDEN).values | {"misalignment": 0.45e-3, "friction": 0.2}
    press = press_to_slide(given)
    # On a flank of 45° the normal force n and friction μ n: down n (1 + μ)/√2, across n (1 - μ)/√2.
    n = press * math.sqrt(2.0) / 1.2
    across = n * 0.8 / math.sqrt(2.0)
    moved = across / given["lateral_stiffness"]
    moved += across * given["half_height"] * given["half_height"] / given["tilt_stiffness"]
    assert moved == pytest.approx(given["misalignment"] - 0.04 * given["half_width"])
    assert press_to_slide(given | {"friction": 1.0}) == math.inf
    assert press_to_slide(given | {"lateral_stiffness": 0.0}) == 0.0


def test_chamfers_that_meet_are_answered_before_a_run(capsys):
    line = ["--device", str(PEG), "--set", "hole_chamfer=0.5 mm"]
    assert cli.main(["assess", *line]) == cli.DONE
    assert "the chamfers meet: no vibration needed" in capsys.readouterr().out
    assert cli.main(["assess", *line, "--json"]) == cli.DONE
    assert json.loads(capsys.readouterr().out)["needs_alignment"] is False
    assert cli.main(["simulate", *line]) == cli.REFUSED
    assert "`vibralign assess` judges" in capsys.readouterr().err


def test_a_landing_on_chamfers_is_known_if_the_press_suffices():
    device = load_device(PEG, SUDDEN | {"misalignment": "0.9 mm", "hole_chamfer": "0.5 mm"})
    meets = device.changed(misalignment=0.45e-3)
    press = float(press_to_slide(meets.values)) / meets.units.force
    results = {name: np.zeros(3) for name in RESULTS}
    more = meets.parameters.given() | {"press_force": np.array([0.9, 1.1, 0.9]) * press}
    more["misalignment"] = np.array([0.45e-3, 0.45e-3, 0.19e-3]) / meets.units.amplitude
    widths = 0.0, 0.5e-3 / meets.units.amplitude
    found = judged_on_chamfers(results, more, widths)  # the last starts inside the hole itself
    assert found["reason"].tolist() == [Reason.ON_FLANK, Reason.BY_PRESS, Reason.NONE]
    assert np.isnan(found["tau_align"]).tolist() == [True, False, False]


def test_tolerances_and_limits_hold_where_chamfers_meet_as_stated(tmp_path, capsys):
    # Chamfers meet up to 0.2 + 0.5 mm; what starts farther out is run.
    file = tmp_path / "peg.yaml"
    file.write_text(
        PEG.read_text().replace("0.6 mm #", "0.6 ± 0.3 mm #")
        + "approach_speed: sudden\ncontact_stiffness: 1 MN/m\nhole_chamfer: 0.5 mm\n"
        "gripper_tilt: 0 deg\nlimits: {stroke: 2 mm}\n"
    )
    stated = load_device(file, needless=True)
    meet = int((yields.drawn(stated, 16)["misalignment"] <= 0.7e-3).sum())
    line = ["assess", "--device", str(file), "--devices", "16", "--tolerance", "1e-6"]
    assert cli.main([*line, "--require", "0.01"]) == 1  # the stroke is 3 mm
    said = capsys.readouterr().out
    assert f"\non chamfers     {meet} of these land" in said
    assert "exceeds the limit of stroke (3 mm > 2 mm)" in said
    assert cli.main([*line, "--json"]) == cli.DONE
    found = json.loads(capsys.readouterr().out)
    assert (found["needs_alignment"], found["yield"]["devices"]) == (False, 16)
    assert meet <= found["yield"]["going_in"]
    with pytest.raises(NoNeedError):
        load_device(file)


def test_a_map_of_the_misalignment_begins_where_chamfers_meet(tmp_path, capsys):
    line = ["--set", "hole_chamfer=0.5 mm", "--set", "approach_speed=sudden", "--resolution", "2"]
    line += ["--x", "misalignment", "0.5 mm", "3 mm", "--y", "press_force", "6 N", "7 N"]
    out = tmp_path / "map.nc"
    assert cli.main(["map", "--device", str(PEG), *line, "--out", str(out)]) == cli.DONE
    words = "\nat once        at 50 % the chamfers meet, or the part starts inside; "
    assert words in capsys.readouterr().out
    with xr.open_dataset(out) as found:
        assert (found["tau_align"].values[:, 0] == 0.0).all()
        assert not (found["tau_align"].values[:, 1] == 0.0).any()
