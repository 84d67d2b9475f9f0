"""Quantities of a data sheet: diameter, play, fits, natural frequencies, fixture, vibrator."""

import math
from pathlib import Path

import numpy as np
import pytest

from model.sweeps.settings import Ensemble
from vibralign import DoubtWarning, load_device, reliable_at, simulate, sweep
from vibralign.answers.cases import cases_of, on_bases
from vibralign.answers.sheet import part_words
from vibralign.answers.si import named_words
from vibralign.answers.yields import drawn
from vibralign.device import DeviceError
from vibralign.device.batches import devices_of
from vibralign.device.fits import play_of
from vibralign.device.instead import INSTEAD

PEG = Path(__file__).resolve().parents[3] / "docs" / "peg.yaml"
SHEET = """
mass: 120 g ± 5 %
axial_frequency: 25 Hz
lateral_frequency: 10 Hz
tilt_frequency: 20 Hz
axial_damping_ratio: 0.1
lateral_damping_ratio: 0.1
tilt_damping_ratio: 0.1
amplitude: 0.6 mm p-p
frequency: 60 Hz
press_force: 4 N
shape: round
diameter: 6 mm
length: 20 mm
inertia: 230 g cm²
friction: 0.15
fit: H7/g6
misalignment: 0.1 mm
gripper_tilt: 0 deg
"""


def sheet(folder: Path, more: str = "") -> Path:
    (folder / "pin.yaml").write_text(SHEET + more, encoding="utf-8")
    return folder / "pin.yaml"


def test_a_data_sheet_is_a_device_file_without_arithmetic(tmp_path):
    found = load_device(sheet(tmp_path)).values
    stiffness = 0.12 * (2.0 * math.pi * 25.0) ** 2
    assert found["half_width"] == 3e-3
    assert found["half_height"] == 10e-3
    assert found["axial_stiffness"] == pytest.approx(stiffness)
    assert found["tilt_stiffness"] == pytest.approx(2.3e-5 * (2.0 * math.pi * 20.0) ** 2)
    assert found["axial_damping"] == pytest.approx(0.2 * math.sqrt(stiffness * 0.12))
    assert found["clearance"] == pytest.approx(14e-6 / 6e-3)  # H7 0 to 12, g6 -12 to -4 µm


def test_an_inertia_that_is_missing_is_named_with_formulas_and_numbers(tmp_path):
    path = sheet(tmp_path)
    path.write_text(SHEET.replace("inertia: 230 g cm²\n", ""), encoding="utf-8")
    # 120 g (3 · 3² + 20²) mm² / 12, and 120 g (6² + 20²) mm² / 12
    with pytest.raises(DeviceError, match=r"needs inertia, .*: here 4\.27 and 4\.36 kg mm²"):
        load_device(path)
    with pytest.raises(DeviceError, match=r"needs inertia, .*block m \(w² \+ h²\) / 12, and"):
        load_device(path, {"centre_height": "30 mm"})


def test_a_length_is_not_made_of_the_height_of_the_mass_centre(tmp_path):
    assert "round, 6 mm by 20 mm, play " in part_words(load_device(sheet(tmp_path)))
    held = load_device(sheet(tmp_path), {"centre_height": "30 mm"})
    assert "round, 6 mm, mass centre 30 mm over its face, play " in part_words(held)
    with pytest.raises(DeviceError, match=r"both place the mass centre, .*: leave length out"):
        load_device(sheet(tmp_path, "centre_height: 30 mm"))
    text = SHEET.replace("length: 20 mm", "centre_height: 30 mm")
    (tmp_path / "held.yaml").write_text(text, encoding="utf-8")
    for name in ("half_height", "length"):
        words = f"{name}: would move the mass centre, which the file states by centre_height"
        with pytest.raises(DeviceError, match=words):
            load_device(tmp_path / "held.yaml", {name: "10 mm"})
        with pytest.raises(ValueError, match=words):
            held.changed(**{name: 0.01})


@pytest.mark.parametrize("name", INSTEAD)
def test_exactly_one_of_a_pair_is_stated_and_a_change_replaces_the_other(tmp_path, name):
    parameter = INSTEAD[name].parameter
    path = sheet(tmp_path)
    own = load_device(path).values[parameter]
    both = sheet(tmp_path, f"\n{parameter}: {own!r}\n")
    with pytest.raises(DeviceError, match="state the same: leave one out"):
        load_device(both)
    path = sheet(tmp_path)
    given = f"{own!r} ± {0.01 * own!r}" if name == "play" else own  # a fit has a tolerance
    stated = load_device(path, {parameter: given})
    assert stated.values[parameter] == pytest.approx(own)
    assert not {n for n, each in INSTEAD.items() if each.parameter == parameter} & {
        *stated.quantities
    }
    assert load_device(path).changed(**{parameter: own}).values == pytest.approx(stated.values)


# Checked against the tables of two public packages, 1,001 fits and 300 classes, all alike.
FITS = {
    ("H7/h6", 6.0): (0, 20), ("H7/g6", 6.0): (4, 24), ("H8/f7", 20.0): (20, 74),
    ("h6/G7", 10.0): (5, 29), ("H7/k6", 6.0): (-9, 11), ("JS7/h6", 10.0): (-7.5, 16.5),
    ("H11/d9", 40.0): (80, 302), ("F8/h6", 3.0): (6, 26), ("H7-p6", 50.0): (-42, -1),
}  # fmt: skip


@pytest.mark.parametrize(("case", "play"), FITS.items())
def test_the_play_of_a_fit_is_that_of_iso_286(case, play):
    fit, diameter = case
    assert np.array(play_of(fit, 1e-3 * diameter)) == pytest.approx(np.array(play) * 1e-6)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"fit": "H7"}, "must be the hole's tolerance class and the part's"),
        ({"fit": "H7/H6"}, "must be the hole's"),
        ({"fit": "Z7/h6"}, "must be the hole's"),
        ({"fit": "H7/h6", "diameter": "60 mm"}, "needs a diameter up to 50 mm; else state play"),
        ({"fit": "H7/p6"}, "an interference or none for half of the pairs"),
        ({"play": 0.0}, "no play or an interference"),
        ({"diameter": "-6 mm", "play": 1e-5}, "diameter = -0.006: must be a finite number > 0"),
        ({"clearance": "0.02 mm"}, "write play: 0.05 mm, of the diameters"),
        ({"diametre": "6 mm"}, "Did you mean 'diameter'"),
    ],
)
def test_what_is_no_fit_or_play_is_refused_with_the_remedy(tmp_path, changes, words):
    with pytest.raises(DeviceError, match=words):
        load_device(sheet(tmp_path), changes)


def test_a_fit_follows_the_diameter_and_has_its_tolerance(tmp_path):
    path = sheet(tmp_path)
    small, large = load_device(path), load_device(path, {"diameter": "8 mm"})
    assert small.quantities["play"] == pytest.approx(14e-6)
    assert large.quantities["play"] == pytest.approx(17e-6)  # H7 0 to 15, g6 -14 to -5 µm
    assert large.tolerances["play"].width == pytest.approx(12e-6)
    changed = load_device(path, {"clearance": "1 % ± 0.1 %"})
    assert changed.values["clearance"] == 0.01
    assert changed.tolerances["clearance"].width == pytest.approx(1e-3)


def test_no_change_loses_a_tolerance(tmp_path):
    changed = load_device(sheet(tmp_path), {"play": "15 µm"})
    assert changed.quantities["play"] == pytest.approx(15e-6)
    assert changed.tolerances["play"].width == pytest.approx(10e-6)  # H7 0 to 12, g6 -12 to -4 µm
    own = load_device(sheet(tmp_path), {"play": "15 µm ± 1 µm"}).tolerances["play"]
    assert own.width == pytest.approx(1e-6)
    words = r"clearance: would replace fit .* as in clearance=VALUE ± WIDTH, or set play"
    with pytest.raises(DeviceError, match=words):
        load_device(sheet(tmp_path), {"clearance": "1 %"})
    text = SHEET.replace("fit: H7/g6", "play: 0.1 mm ± 0.03 mm")
    (tmp_path / "loose.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(DeviceError, match="would replace play of the file without its tolerance"):
        load_device(tmp_path / "loose.yaml", {"clearance": "1 %"})


def test_a_fixture_is_in_series_with_the_base_stated_or_tried(tmp_path):
    stated = load_device(sheet(tmp_path, "contact_stiffness: 200 kN/m\nfixture_stiffness: 50 N/mm"))
    assert stated.values["contact_stiffness"] == pytest.approx(40e3)  # 200 · 50 / 250
    hung = load_device(sheet(tmp_path, "fixture_stiffness: 50 N/mm"), {"fit": "H7/d8"})
    own = {"friction": np.array([0.15])}
    batch, units = devices_of(hung, own)
    cases = cases_of(hung, Ensemble())
    found = on_bases(batch, units, cases, "round", hung.fixture)["contact_stiffness"][0]
    assert (found * units[0].axial_stiffness < 50e3).all()
    free = on_bases(batch, units, cases, "round")["contact_stiffness"][0]
    tried = ~np.isnan([case["level"] for case in cases])
    series = 1.0 / (1.0 / free + units[0].axial_stiffness / 50e3)
    assert found[tried] == pytest.approx(series[tried])


def test_what_the_vibrator_cannot_give_and_resonance_are_said(tmp_path):
    stated = load_device(sheet(tmp_path, "limits: {acceleration: 4 g, stroke: 0.5 mm}"))
    exceeded = [each for each in stated.doubts if "the vibrator's limit" in each]
    assert [each.rpartition(" ")[2] for each in exceeded] == ["acceleration", "stroke"]  # 4.3 g
    wide = load_device(sheet(tmp_path, "limits: {acceleration: 5 g, stroke: 0.7 mm}"))
    assert not any("the vibrator's limit" in each for each in wide.doubts)
    for direction, frequency in (("axial", 27.0), ("lateral", 9.1), ("tilt", 21.9)):
        doubts = load_device(sheet(tmp_path), {"frequency": frequency}).doubts
        [said] = [each for each in doubts if "resonance" in each]
        assert f"natural frequency, {direction}," in said
    assert not any("resonance" in each for each in load_device(PEG).doubts)


def test_python_warns_of_what_the_command_warns_of(tmp_path):
    wide = load_device(PEG, {"amplitude": "50 m"})
    with pytest.warns(DoubtWarning, match="amplitude = 50 m is longer than a metre"):
        simulate(wide, horizon=1.0)
    with pytest.warns(DoubtWarning, match="longer than a metre"):
        reliable_at(wide, friction=[0.1])
    with pytest.warns(DoubtWarning, match=r"at amplitude = 2 m: amplitude = 2 m is longer than"):
        sweep(PEG, amplitude=[1e-3, 2.0], horizon="10 ms")
    text = PEG.read_text(encoding="utf-8").replace("amplitude: 1.5 mm", "amplitude: 15 g")
    (tmp_path / "peg.yaml").write_text(text, encoding="utf-8")
    with pytest.warns(DoubtWarning, match="stays so at another frequency"):
        sweep(tmp_path / "peg.yaml", frequency="40 to 60 Hz", points=2, horizon="10 ms")


def test_what_is_written_out_has_the_units_it_came_in(tmp_path):
    stated = load_device(sheet(tmp_path))
    words = named_words({"mass": 0.1234, "amplitude": 0.35e-3, "play": 12.34e-6}, stated)
    assert words == "mass = 123.4 g, amplitude = 0.7 mm p-p, play = 0.01234 mm"
    for name, column in drawn(stated, 8).items():
        unit, one = stated.written[name]
        for value in column.tolist():
            assert (
                load_device(stated.source, {name: f"{value / one:.6g} {unit}"}).quantities[name]
                == value
            )
