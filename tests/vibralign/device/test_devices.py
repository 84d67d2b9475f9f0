"""Device files: amounts with units and tolerances, plausibility, read or refused."""

import math
import re
from pathlib import Path

import pytest

from model.events.outcomes import Outcome
from model.physics.quantities import FREQUENCY
from vibralign import align
from vibralign.device import DeviceError, Tolerance, load_device
from vibralign.device.holder import natural_frequencies

EXAMPLE = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
ROUND = EXAMPLE.parents[2] / "docs" / "peg.yaml"
WHOLE = {"half_width": "10 mm", "half_height": "40 mm"}
HERTZ = {"materials": "steel on aluminium", "edge_radius": "0.2 mm"}


def peg(folder: Path, more: str = "", **replaced: str) -> Path:
    """Write the example with values of its lines replaced, and lines more."""
    text = EXAMPLE.read_text(encoding="utf-8")
    for name, value in replaced.items():
        text = re.sub(rf"^{name}: [^#\n]*", f"{name}: {value}  ", text, flags=re.MULTILINE)
    (folder / "peg.yaml").write_text(text + more, encoding="utf-8")
    return folder / "peg.yaml"


def test_the_example_aligns():
    runs = align([load_device(EXAMPLE, {}).parameters], tolerance=1e-7, horizon=50.0, cores=1)
    assert runs.outcome[0] == Outcome.ALIGNED
    assert runs.separations[0] == 0
    assert load_device(EXAMPLE).doubts == []


def test_changes_are_in_the_units_of_the_file():
    before, after = (load_device(EXAMPLE, change) for change in ({}, {"press_force": "0.03 kN"}))
    assert after.parameters.press_force == pytest.approx(3.0 * before.parameters.press_force)
    assert load_device(EXAMPLE, {"amplitude": 0.5e-3}).parameters.half_width == pytest.approx(10.0)


def test_the_shape_may_be_changed():
    assert load_device(EXAMPLE).shape == "square"
    assert load_device(EXAMPLE, {"shape": "round"}).shape == "round"
    with pytest.raises(DeviceError, match=r"unknown shape 'oval'.*flat sides write square"):
        load_device(EXAMPLE, {"shape": "oval"})


def test_a_changed_value_keeps_its_tolerance(tmp_path):
    path = peg(tmp_path, friction="0.15 ± 0.05")
    stated = load_device(path, {"friction": 0.2})
    assert stated.quantities["friction"] == 0.2
    assert stated.tolerances == {"friction": Tolerance("uniform", 0.05)}
    assert load_device(path, {"friction": "0.2 ± 0.01"}).tolerances["friction"].width == 0.01
    with pytest.raises(DeviceError, match="at the ends of the tolerances"):
        load_device(path, {"misalignment": "10 mm ± 0.2 mm"})


REFUSED_FREE = {
    "clearance: -0.01 to 0.05": "no play or an interference",
    "clearance: 0 to 5 %": "no play or an interference",
    "press_force: -4 to 12 N": "free: press_force = -4.0: must be > 0, or nothing presses",
    "friction: -0.1 to 0.2": "free: friction = -0.1: must be a finite number >= 0",
    "mass: 0 to 1 kg": "free: mass = 0.0: must be a finite number > 0",
    "misalignment: 0.5 to 60 mm": "free: misalignment = 0.06: must be smaller than half_width",
    "friction: a lot": "must be a range such as 2 to 30$",
}


@pytest.mark.parametrize(("free", "words"), REFUSED_FREE.items())
def test_a_range_that_breaks_the_rule_of_its_quantity_is_refused(tmp_path, free, words):
    with pytest.raises(ValueError, match=words):
        load_device(peg(tmp_path, more=f"\nfree: {{{free}}}\n"))


def test_free_quantities_and_limits_are_read(tmp_path):
    more = "free: {press_force: 2 to 30 N}\nlimits: {contact_force: 60 N, tilt: 10 deg}\n"
    stated = load_device(peg(tmp_path, more))
    assert stated.free == {"press_force": (2.0, 30.0)}
    assert stated.limits == {"contact_force": 60.0, "tilt": pytest.approx(math.radians(10.0))}
    for wrong in ("free: 3", "free: {presure: 1 to 2}", "limits: {force: 3}", "limits: {time: 0}"):
        with pytest.raises(DeviceError) as refusal:
            load_device(peg(tmp_path, wrong))
    assert "longest time until alignment, not until insertion" in str(refusal.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"press_force": -60.0}, "press_force = -60.0: must be > 0"),
        ({"press_force": 0.0}, "press_force = 0.0: must be > 0"),
        ({"clearance": 0.2}, "misalignment = 0.8 mm: already inside at the start"),
        ({"misalignment": 0.0}, "already inside at the start"),
        (HERTZ | {"restitution": 0.5, "press_force": "-6 N"}, "press_force = -6.0: must be > 0"),
        ({"clearance": 0.83}, "not a length; write 0.0083, or '0.83 %', if it is in per cent"),
        ({"materials": "wood on steel"}, "materials = 'wood on steel': must be the part's on"),
        ({"materials": "steel"}, "for others state contact_stiffness"),
        ({"materials": "steel on steel"}, "such as edge_radius: 0.1 mm; or leave materials out"),
        ({"fit": "H7/m6"}, "state a fit with play, such as H7/g6, or the play of your parts"),
        ({"edge_radius": 1e-3}, "edge_radius needs materials"),
        ({"restitution": 1.2}, "restitution = 1.2: must be a finite number > 0 and <= 1"),
        ({"restitution": 0.5, "contact_damping": 3.0}, "state the same"),
        (HERTZ | {"contact_stiffness": 1e6}, "state the same"),
        (HERTZ | {"plate_radius": 0.1}, "a plate needs both"),
        (
            {"restitution": 60},
            "must be a finite number > 0 and <= 1; write 0.6, or '60 %', if it is in",
        ),
    ],
)
def test_a_device_that_makes_no_sense_is_refused(changes, words):
    with pytest.raises(DeviceError) as refusal:
        load_device(EXAMPLE, changes)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"half_width": 5, "misalignment": 0.8}, "half_width = 5 m is longer than"),
        ({"inertia": "4.5e-5 kg cm²"}, "radius of gyration of 0.122 mm"),
        ({"mass": "300 kg"}, "mass = 300 kg is 7.5e+07 kg/m³ of a box of the part's size; inertia"),
        (WHOLE, "with half_width = 10 mm and half_height = 40 mm has 23.8 mm: half_width is half"),
        ({"half_height": "40 mm"}, "half_height half the length"),
        ({"amplitude": "6 mm"}, "amplitude = 6 mm is larger than half_width = 5 mm"),
        ({"misalignment": "6 mm"}, "misalignment = 6 mm is larger than half_width"),
        ({"clearance": 0.7, "misalignment": "4 mm"}, "the hole is 1.7 times as wide"),
        ({"friction": 15}, "friction = 15 is more than 1; write 0.15, or '15 %', if it is in per"),
        ({"clearance": 0.83, "misalignment": "4.5 mm"}, "; write 0.0083, or '0.83 %', if it is"),
        ({"tilt_damping_ratio": 3}, "ratio = 3 is more than 1; write 0.03, or '3 %', if it is"),
        ({"axial_damping_ratio": 7}, "ratio = 7 is more than 1; write 0.07, or '7 %', if it is"),
        ({"frequency": 0.05}, "have their resonance at 15.9 Hz"),
        ({"press_force": "10 kN"}, "amplitude of 3 N"),
        ({"axial_damping": 0.07}, "if 0.07 is the ratio, write axial_damping_ratio"),
        ({"tilt_stiffness": 500}, "a natural frequency of 531 Hz, the axial one is 15.9 Hz"),
        ({"gripper_tilt": 0.6, "misalignment": "2 mm"}, "gripper_tilt = 0.6 rad is 34.38°: write"),
        ({"contact_stiffness": "20 GN/m"}, "more than steel of this size has"),
    ],
)
def test_a_doubtful_value_is_named(changes, words):
    [doubt, *_] = load_device(EXAMPLE, changes).doubts
    assert words in doubt


def test_a_doubt_says_that_a_unit_is_missing(tmp_path):
    stiffness = load_device(peg(tmp_path, axial_stiffness="3")).doubts
    assert stiffness[-1] == "axial_stiffness is stated without a unit, so it is taken as 3 N/m"
    (tilt,) = load_device(peg(tmp_path, "gripper_tilt: 0 ± .2")).doubts
    assert "± 0.2 is ± 11.46°, since it has no unit: write ± 0.2 deg" in tilt
    for more, stated in (("", {"axial_stiffness": "3 N/m"}), ("gripper_tilt: 0 ± .2 rad", {})):
        doubts = load_device(peg(tmp_path, more, **stated)).doubts
        assert not any("unit" in each for each in doubts)


@pytest.mark.parametrize("path", [EXAMPLE, *EXAMPLE.parent.glob("devices/*.yaml")], ids=str)
def test_no_quantity_may_be_a_thousand_times_off_unnoticed(path):
    stated = load_device(path)
    own = stated.resolved({})
    measured = {name: own[name] for name in ("contact_stiffness", "contact_damping") if name in own}
    assert stated.doubts == load_device(path, measured).doubts == []
    for changes in ({}, measured):
        for name, value in load_device(path, changes).quantities.items():
            for factor in (1e-3, 1e3):
                try:
                    assert load_device(path, {**changes, name: value * factor}).doubts, name
                except DeviceError as refusal:
                    assert name in str(refusal) or "already inside" in str(refusal)  # noqa: PT017


def test_the_inertia_of_a_solid_part_is_not_doubted():
    # The least inertia of a solid part, that of an ellipsoid m(a² + b²)/5, is 0.6 of a rectangle's.
    bare = 0.3 * (0.005**2 + 0.02**2) / 5.0
    assert load_device(EXAMPLE, {"inertia": 1.001 * bare}).doubts == []
    assert len(load_device(EXAMPLE, {"inertia": 0.999 * bare}).doubts) == 1


def test_a_damping_ratio_stands_for_a_damping(tmp_path):
    path = tmp_path / "peg.yaml"
    text = EXAMPLE.read_text(encoding="utf-8")
    for name in ("axial", "lateral", "tilt"):
        text = text.replace(f"{name}_damping:", f"{name}_damping_ratio: 0.07 ± 0.02 #")
    path.write_text(text, encoding="utf-8")
    stated = load_device(path)
    # 2ζ√(k m): mass 0.3 kg, inertia 4.5e-5 kg m², stiffnesses 3000 and 50 N/m, 0.5 N m/rad
    dampings = 0.14 * math.sqrt(3000 * 0.3), 0.14 * math.sqrt(50 * 0.3), 0.14 * math.sqrt(2.25e-5)
    names = ("axial_damping", "lateral_damping", "tilt_damping")
    found = stated.resolved({})
    assert tuple(found[name] for name in names) == pytest.approx(dampings)
    assert stated.doubts == []
    # The ratio is what is stated: it and its tolerance hold for another stiffness.
    assert stated.resolved({"axial_stiffness": 12e3})["axial_damping"] == pytest.approx(
        2.0 * dampings[0]
    )
    assert stated.tolerances["tilt_damping_ratio"] == Tolerance("uniform", 0.02)
    # A damping replaces the ratio of the file, and a ratio the damping.
    damped = load_device(path, {"axial_damping": "3 ± 0.9"})
    assert damped.resolved({})["axial_damping"] == 3.0
    with pytest.raises(DeviceError, match="axial_damping: would replace axial_damping_ratio"):
        load_device(path, {"axial_damping": 3.0})
    replaced = load_device(EXAMPLE, {"axial_damping_ratio": 0.07}).resolved({})
    assert replaced["axial_damping"] == pytest.approx(dampings[0])
    path.write_text(f"{text}\naxial_damping: 6\n", encoding="utf-8")
    with pytest.raises(DeviceError, match="axial_damping and axial_damping_ratio state the same"):
        load_device(path)
    with pytest.raises(DeviceError, match=r"axial_damping_ratio = -0\.1: must be a finite number"):
        load_device(EXAMPLE, {"axial_damping_ratio": -0.1})


def test_the_natural_frequencies_are_those_of_the_three_springs():
    peg = load_device(EXAMPLE, {})
    natural = {
        name: value * peg.units.of(FREQUENCY)
        for name, value in natural_frequencies(peg.parameters).items()
    }
    expected = {"axial": 3000 / 0.3, "lateral": 50 / 0.3, "tilt": 0.5 / 4.5e-5}
    assert natural == pytest.approx(
        {name: math.sqrt(value) / (2.0 * math.pi) for name, value in expected.items()}
    )


def test_yaml_does_not_reckon_with_numbers(tmp_path):
    assert load_device(peg(tmp_path, frequency="050")).quantities["frequency"] == 50.0
    for refused in ("0x32", "1:30", "5_0"):
        with pytest.raises(DeviceError, match=f"frequency = '{refused}'"):
            load_device(peg(tmp_path, frequency=refused))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_device_saved_in_another_encoding_is_read_or_refused_with_the_remedy(tmp_path, encoding):
    path = peg(tmp_path, friction="0.15 ± 0.05")
    path.write_bytes(path.read_text(encoding="utf-8").encode(encoding))
    if encoding == "cp1252":
        with pytest.raises(DeviceError, match="line 20 is not UTF-8 text: save the file as UTF-8"):
            load_device(path)
    else:
        assert load_device(path).tolerances["friction"].width == 0.05


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be lines of NAME: VALUE"),
        ("[1, 2]", "must be lines of NAME: VALUE"),
        ("mass: [", "cannot be read as YAML"),
        ("mass: heavy", "mass = 'heavy': must be a number in kg"),
        ("mass: true", "mass = True: must be a number in kg"),
        ("mass: 1", "axial_stiffness is missing: a device needs"),
        ("start: slow", "unknown start 'slow'. Valid: simultaneous, pressed"),
        ("mas: 1", "unknown quantity of a device 'mas'. Did you mean 'mass'"),
        ("width: 12 mm", "'width'. Write diameter, of a square part its width; half_width is half"),
        ("height: 9 mm", "'height'. Write length, of the whole part; half_height is half of it."),
        ("mass: 1\nmass: 2", "mass: given twice"),
        ("? [1]\n: 2", "cannot be read as YAML"),
    ],
)
def test_an_invalid_device_is_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "peg.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DeviceError) as refusal:
        load_device(path, {})
    assert message in str(refusal.value)
    assert str(refusal.value).startswith(str(path))
    assert "\n" not in str(refusal.value)


def test_a_stated_base_replaces_what_the_file_derives_it_from() -> None:
    shaft = EXAMPLE.parent / "devices" / "shaft.yaml"
    own = load_device(shaft).resolved({})
    changes = {name: own[name] for name in ("contact_stiffness", "contact_damping")}
    stated = load_device(shaft, {**changes, "press_force": "18 N"})
    assert stated.materials is None
    found = stated.resolved({})
    assert {name: found[name] for name in changes} == changes
    # The other way round the file's materials give a new one.
    assert load_device(shaft, {"press_force": 18.0}).resolved({})["contact_stiffness"] == (
        pytest.approx(own["contact_stiffness"] * 1.5 ** (1.0 / 3.0))
    )


def test_an_amplitude_in_g_holds_at_the_frequency_of_the_file(tmp_path):
    file = peg(tmp_path, amplitude="5 g")
    amplitude = 5.0 * 9.80665 / (2.0 * math.pi * 50.0) ** 2
    assert load_device(file).quantities["amplitude"] == pytest.approx(amplitude)
    other = load_device(file, {"frequency": "80 Hz"})
    assert other.quantities["amplitude"] == pytest.approx(amplitude)  # as in leeways and maps
    assert "amplitude = 5 g is 0.4968 mm at 50 Hz, and stays so" in other.doubts[0]
    both = load_device(file, {"frequency": "80 Hz", "amplitude": "5 g"})
    assert both.quantities["amplitude"] == pytest.approx(amplitude * (50.0 / 80.0) ** 2)
    assert not both.notes
    free = peg(tmp_path, amplitude="5 g", more="\nfree:\n  frequency: 40 to 60 Hz\n")
    with pytest.raises(DeviceError, match=r"is an acceleration.*write the amplitude in mm"):
        load_device(free)
    with pytest.raises(DeviceError, match=r"is an acceleration.*write the amplitude in mm"):
        load_device(peg(tmp_path, amplitude="5 g", frequency="50 Hz ± 1 Hz"))


@pytest.mark.parametrize("given", ["-2 um", "-0.03 %", "−2 µm / 6 mm", -0.0003, 0, "0 %"])
def test_a_fit_without_play_is_said_not_to_be_modelled(given):
    with pytest.raises(DeviceError, match=r"an interference .* is not modelled.* clearance > 0"):
        load_device(EXAMPLE, {"clearance": given})


def test_a_contact_that_yields_as_much_as_the_lever_is_doubted():
    # T10: 2 a (F + F1) / (K (g² - x²)), with a = 5 mm, F + F1 = 9 N, g² = (5.2² - 5²) mm²
    at_half = 2.0 * 5e-3 * 9.0 / (0.5 * (5.2e-3**2 - 5e-3**2 - 0.6e-3**2))
    own = {"press_force": "6 N", "amplitude": "1 mm", "axial_stiffness": 3000}
    soft, firm = (
        load_device(ROUND, {**own, "contact_stiffness": factor * at_half}).doubts
        for factor in (0.99, 1.01)
    )
    (doubt,) = (each for each in soft if each not in firm)
    assert doubt.startswith(f"soft base: at contact_stiffness = {0.99 * at_half:.4g} N/m, stated")
    assert "if it is below, the lever is longer still: widen the play" in doubt
    assert "lever of the press may be 51 % longer: do not trust the verdict" in doubt
    assert f"contact_stiffness if it is above {at_half:.3g} N/m" in doubt
    square = {"contact_stiffness": 0.99 * at_half}
    assert not any("soft base" in each for each in load_device(EXAMPLE, square).doubts)
    # A base that is not stated is taken to be one, and may be too soft for a tight fit.
    tight = {"clearance": 0.001, "misalignment": "0.1 mm"}
    assert [each[:9] for each in load_device(ROUND, tight).doubts] == ["soft base"]


def test_a_part_that_starts_on_the_rounding_of_the_edge_is_doubted():
    # It lies on the edge by 0.6 mm - 0.04 * 5 mm = 0.4 mm.
    assert load_device(ROUND, {**HERTZ, "edge_radius": "0.39 mm"}).doubts == []
    (doubt,) = load_device(ROUND, {**HERTZ, "edge_radius": "0.41 mm"}).doubts
    assert "edge_radius = 0.41 mm, while the part lies on the edge by at most 0.4 mm" in doubt
    assert "it starts on the rounding, and the model has sharp edges" in doubt
