"""The worked devices of the documentation, in small: verdict, base, yield."""

from pathlib import Path

import pytest

from model.physics.parameters import Batch
from model.sweeps.starts import every_start
from vibralign import Settings
from vibralign.answers.yields import yield_of
from vibralign.device import load_device

DEVICES = Path(__file__).resolve().parents[3] / "docs" / "devices"
STARTS = [{"phase": phase, "gripper_tilt": 0.001} for phase in (0.0, 1.6, 3.1, 4.7)]
QUICK = Settings(shape="round", horizon=150.0, tolerance=1e-6)


@pytest.mark.parametrize(
    ("name", "stiffness", "shares"),
    # Hertz by hand: 1/E* = Σ(1 - ν²)/E, k = (6 E*² R F)^(1/3); the peg's plate yields besides
    [("pin", 4.82e4, (1.0, 1.0)), ("peg", 1.96e6, (1.0, 1.0)), ("shaft", 5.43e6, (0.4, 0.95))],
)
def test_a_worked_device_goes_in_on_its_base(name, stiffness, shares):
    stated = load_device(DEVICES / f"{name}.yaml")
    assert stated.doubts == []
    assert stated.resolved({})["contact_stiffness"] == pytest.approx(stiffness, rel=5e-3)
    assert goes_in(stated).all()
    found, _ = yield_of(stated, STARTS, QUICK, devices=8, indices=False)
    assert shares[0] <= found.share <= shares[1]


def test_the_shaft_does_not_go_in_pressed_hard():
    """From no start once it is at rest under the press; lowered vibrating, from some."""
    hard = load_device(DEVICES / "shaft.yaml", {"press_force": "60 N"})
    assert not goes_in(hard.changed(vibrator="still")).any()
    assert not goes_in(hard).all()


def goes_in(stated):
    """Return from which of the starts a device goes in, lowered as a single run of it is."""
    settings = stated.run_settings(QUICK, stated.units)
    return every_start(Batch.stack([stated.parameters]), STARTS, settings)["goes_in"]
