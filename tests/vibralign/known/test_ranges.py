"""Ranges of what is unknown: reading, refusals, and a verdict over what is possible."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import qmc

from model.events.insertion import INSERTION
from model.runs.settings import Settings
from vibralign import DoubtWarning, covering, known_in_part, load_device, simulate
from vibralign.commands import main as cli
from vibralign.commands.known import possible_lines
from vibralign.device.unknown import Range
from vibralign.known.doubt import unknowns_of
from vibralign.known.possible import run_sets, sets_of, touch_downs

PEG = """
mass: 0.3 kg
axial_stiffness: 3 kN/m
amplitude: 2 mm
frequency: 50 Hz
press_force: 5 N
lateral_stiffness: 50 N/m
tilt_stiffness: 0.3 N m/rad
axial_damping: 6 N s/m
lateral_damping: 8 N s/m
tilt_damping: 4 mN m s/rad
shape: round
half_width: 5 mm
half_height: 20 mm
inertia: 450 g cm²
clearance: 4 %
misalignment: 0.6 mm ± 0.1 mm
contact_stiffness: 1 MN/m
approach_speed: sudden
gripper_tilt: 0 deg
"""
RANGES = "unknown: {friction: 0.1 to 0.3, lateral_stiffness: 20 to 100 N/m}\n"
PART = PEG.replace("lateral_stiffness: 50 N/m\n", "") + RANGES


def device_file(folder, text: str = PART):
    path = folder / "own.yaml"
    path.write_text(text)
    return path


def test_a_range_stands_apart_and_has_a_middle(tmp_path):
    device = load_device(device_file(tmp_path))
    assert device.unknown == {"friction": Range(0.1, 0.3), "lateral_stiffness": Range(20.0, 100.0)}
    assert not device.unknown["friction"].is_log
    assert device.unknown["lateral_stiffness"].is_log  # a factor of five
    assert device.quantities["friction"] == pytest.approx(0.2)
    assert device.quantities["lateral_stiffness"] == pytest.approx(np.sqrt(2000.0))
    assert device.written["lateral_stiffness"] == ("N/m", 1.0)
    assert device.changed(friction=0.2).unknown.keys() == {"lateral_stiffness"}
    both = {"friction": "0.2 ± 0.02", "lateral_frequency": "3 Hz"}
    known = load_device(device.source, both)  # what replaces an unknown makes it known
    assert not known.unknown
    assert set(known.tolerances) == {"friction", "misalignment"}


def test_a_value_that_is_left_blank_may_be_unknown(tmp_path):
    blank = PART.replace("mass: 0.3 kg\n", "mass: 0.3 kg\nfriction:\nlateral_frequency:\n")
    device = load_device(device_file(tmp_path, blank))
    assert device.unknown.keys() == {"friction", "lateral_stiffness"}


# What stands below the lines of PEG, and what the refusal must hold.
REFUSED = [
    ("unknown: {friction: 0.2}", ["unknown: friction = '0.2'", "must be a range"]),
    ("unknown: {friction: 0.3 to 0.1}", ["must rise"]),
    ("unknown: {friction: -0.1 to 0.1}", ["unknown: friction", ">= 0"]),
    ("unknown: {mass: 0.2 to 0.3 kg}", ["mass: is unknown, and mass states it"]),
    ("unknown: {lateral_frequency: 1 to 3 Hz}", ["lateral_stiffness states it: leave one out"]),
    ("unknown: {friction: 0.1 to 0.2}\nfree: {friction: 0.1 to 0.2}", ["below unknown and below"]),
    ("unknown: {phase: 0 to 1}", ["every phase is tried"]),
    ("unknown: {frictoin: 0.1 to 0.3}", ["'frictoin'", "'friction'"]),
    ("unknown: 3", ["unknown = '3'", "NAME: VALUE"]),
    ("friction: 0.1 to 0.35", ["`unknown: {friction: 0.1 to 0.35}`"]),
    ("unknown: {friction: 0.1 to 0.3}\nunknown_samples: no.nc", ["no.nc", "vibralign calibrate"]),
]


@pytest.mark.parametrize(("lines", "words"), REFUSED)
def test_what_is_no_range_is_refused(tmp_path, lines, words):
    with pytest.raises(ValueError, match=r"own\.yaml") as refusal:
        load_device(device_file(tmp_path, PEG + lines))
    assert all(each in str(refusal.value) for each in words)


def test_single_values_are_asked_for_where_they_are_needed(tmp_path, capsys):
    path = device_file(tmp_path)
    for words in (["simulate"], ["explore", "--out", str(tmp_path / "a.html")],
                  ["map", "--x", "press_force", "1 N", "9 N", "--y", "mass", "0.2", "0.4", "--out",
                   str(tmp_path / "a.nc")]):  # fmt: skip
        assert cli.main([*words, "--device", str(path)]) == cli.REFUSED
        assert "friction, lateral_stiffness: unknown" in capsys.readouterr().err
    with pytest.raises(ValueError, match="known_in_part"):
        simulate(path)
    bare = PART.replace("gripper_tilt: 0 deg\n", "")
    missing = bare.replace("contact_stiffness: 1 MN/m", "materials: POM on steel")
    for text, words in ((bare, ""), (missing, "materials needs edge_radius")):
        assert cli.main(["assess", "--device", str(device_file(tmp_path, text))]) == cli.REFUSED
        said = capsys.readouterr().err
        assert words in said
        assert "gripper_tilt: 0 ± 0.1 deg" in said


def test_the_unknown_that_decides_is_named_with_its_border():
    shares = qmc.Sobol(3, rng=np.random.default_rng(0)).random(512)
    ranges = dict.fromkeys("abc", Range(0.0, 2.0))
    sets = {name: 2.0 * column for name, column in zip("abc", shares.T, strict=True)}
    first, *others = unknowns_of(ranges, sets, sets["b"] < 0.6)
    assert first.name == "b"
    assert first.share == pytest.approx(1.0, abs=0.1)
    assert first.worth > 0.9
    assert {(side, verdict) for side, _, verdict in first.borders} == {
        ("below", True), ("above", False),
    }  # fmt: skip
    assert all(value == pytest.approx(0.6, abs=0.02) for _, value, _ in first.borders)
    assert all(each.worth < 0.05 and not each.borders for each in others)
    # Of a + b < 0.8: E[verdict | a] = 0.8 - a on the unit square, so a share of 0.0683 / 0.2176.
    sums = unknowns_of(ranges, sets, sets["a"] + sets["b"] < 1.6)
    assert {each.name for each in sums[:2]} == {"a", "b"}
    for each in sums[:2]:
        assert each.low - 0.05 < 0.0683 / 0.2176 < each.high + 0.05
    alone = unknowns_of(ranges, sets, np.ones(512, np.bool_))  # nothing is in doubt
    assert all(np.isnan(each.share) and each.worth == 0.0 for each in alone)


def test_a_set_is_reliable_as_its_own_runs_say(tmp_path):
    device = load_device(device_file(tmp_path))
    settings = Settings(scene=INSERTION, tolerance=1e-6)
    sets, downs = sets_of(device, 4), touch_downs(device, 4)
    runs = run_sets(device, sets, downs, settings)
    assert runs.time.shape == (4, 4)
    for i, j in ((0, 0), (3, 2)):
        values = {name: float(each[i]) for name, each in sets.items()}
        values |= {name: float(each[j]) for name, each in downs.items()}
        one = simulate(device.changed(**values), settings)
        expected = one.tau_align * one.units.time
        np.testing.assert_allclose(runs.time[i, j], expected, rtol=1e-3)
    found = known_in_part(device, settings, sets=4, touch_downs_tried=4)
    assert not runs.late.any()
    assert found.reliable.tolist() == np.isfinite(runs.time).all(axis=1).tolist()
    for own, soft in ((device, False), (device.changed(contact_stiffness=1e4), True)):
        assert possible_lines(found, own, 1.0)[0].endswith("the base is soft") == soft
    strict = load_device(device_file(tmp_path, PART + "limits: {time: 1 us}"))
    assert not known_in_part(strict, settings, sets=4, touch_downs_tried=4).reliable.any()


def test_assess_answers_over_what_is_possible(tmp_path, capsys):
    path = device_file(tmp_path)
    assert cli.main(["assess", "--device", str(path), "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["interval"][0] <= record["share"] <= record["interval"][1]
    assert {each["name"] for each in record["unknowns"]} == {"friction", "lateral_stiffness"}
    command = ["assess", "--device", str(path), "--sheet", str(tmp_path / "a.html")]
    assert cli.main(command) == cli.REFUSED
    assert "while quantities are unknown" in capsys.readouterr().err


def test_a_share_that_only_the_horizon_limits_is_said(tmp_path, capsys):
    """At a horizon of 40 ms nothing is in; the slowest set takes 282 ms (horizon not reached)."""
    path = device_file(tmp_path)
    assert cli.main(["assess", "--device", str(path), "--horizon", "40 ms"]) == cli.DONE
    words = "too short for 100 % of what is possible: the part still moves after 40 ms; "
    assert f"horizon         {words}try --horizon '160 ms'\n" in capsys.readouterr().out
    device, settings = replace(load_device(path), horizon=0.04), Settings(scene=INSERTION)
    few = {"sets": 8, "touch_downs_tried": 4}
    assert known_in_part(device, settings, **few).undecided == 1.0
    assert known_in_part(replace(device, horizon=None), settings, **few).undecided == 0.0
    limited = replace(device, limits={"time": 0.03})  # by then it has failed
    assert known_in_part(limited, settings, **few).undecided == 0.0
    stuck = load_device(path, {"amplitude": "0.02 mm"})  # a longer horizon does not help
    assert known_in_part(stuck, settings, **few).undecided == 0.0


def test_the_details_of_ranges_say_what_is_assumed(tmp_path, capsys):
    path = device_file(tmp_path)
    line = ["assess", "--details", "--horizon", "5 ms", "--device", str(path)]
    assert cli.main(line) == cli.DONE
    said = capsys.readouterr().out
    assert "\n  base        contact stiffness 1 MN/m (as stated)" in said
    assert "\n  horizon     5 ms" in said


def test_the_setting_covers_most_of_what_is_possible(tmp_path):
    free = PART + "free: {press_force: 4 to 40 N, amplitude: 1 to 2.5 mm}\n"
    device = load_device(device_file(tmp_path, free))
    found = covering(device, count=4, sets=16)
    assert found.tried == 8
    assert found.setting.keys() == {"press_force", "amplitude"}
    for name, value in found.setting.items():
        assert device.free[name][0] <= value <= device.free[name][1]
    again = known_in_part(device.changed(**found.setting), sets=16)
    assert again.share == found.possible.share
    hardest = known_in_part(device.changed(press_force=40.0, amplitude=1e-3), sets=16)
    assert found.possible.share > hardest.share
    assert 0.0 <= found.knowing_adds <= 1.0 - found.possible.share + 0.2
    with pytest.raises(ValueError, match="nothing is free"):
        covering(device_file(tmp_path))


def test_doubtful_values_are_still_named(tmp_path):
    path = device_file(tmp_path, PART.replace("shape: round\n", ""))
    with pytest.warns(DoubtWarning, match="shape is not stated"):
        load_device(path).warn()
