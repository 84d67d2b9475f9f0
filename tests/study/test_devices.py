"""Device files: read or refused."""

from pathlib import Path

import pytest

from model import align
from model.events.outcomes import Outcome
from model.study.devices import DeviceError, load_device

EXAMPLE = Path(__file__).resolve().parents[2] / "docs" / "peg.yaml"


def test_the_example_aligns():
    runs = align([load_device(EXAMPLE, {}).parameters], tolerance=1e-7, horizon=50.0, cores=1)
    assert runs.outcome[0] == Outcome.ALIGNED
    assert runs.separations[0] == 0


def test_a_number_without_a_point_is_a_number(tmp_path):
    path = tmp_path / "peg.yaml"
    path.write_text(EXAMPLE.read_text(encoding="utf-8").replace("0.005 #", "5e-3 #"), "utf-8")
    assert load_device(path, {}) == load_device(EXAMPLE, {})
    assert "5e-3" in path.read_text(encoding="utf-8")


def test_changes_are_in_the_units_of_the_file():
    before, after = (load_device(EXAMPLE, change) for change in ({}, {"press_force": 30.0}))
    assert after.parameters.press_force == pytest.approx(3.0 * before.parameters.press_force)
    assert load_device(EXAMPLE, {"amplitude": 0.5e-3}).parameters.half_width == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must be lines of NAME: VALUE"),
        ("[1, 2]", "must be lines of NAME: VALUE"),
        ("mass: [", "cannot be read as YAML"),
        ("mass: heavy", "mass = 'heavy': must be a number, in SI units"),
        ("mass: true", "mass = True: must be a number, in SI units"),
        ("mass: 1", "axial_stiffness is missing: a device needs"),
        ("mas: 1", "unknown quantity of a device 'mas'. Did you mean 'mass'"),
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


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(DeviceError, match=r"peg\.yaml: cannot be read"):
        load_device(tmp_path / "peg.yaml", {})
