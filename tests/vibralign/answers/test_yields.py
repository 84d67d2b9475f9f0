"""Yields: distributions, Sobol' indices of a closed form, the nearest device that fails."""

import shlex
from pathlib import Path

import numpy as np
import pytest

from vibralign import Settings
from vibralign.answers import yields
from vibralign.answers.yields import (
    DeviceResults,
    distribution,
    drawn,
    interval,
    nearest_failing,
    sobol_cubes,
    total_indices,
    yield_of,
)
from vibralign.commands import main as cli
from vibralign.device import Tolerance, load_device

PEG = Path(__file__).resolve().parents[2] / "square" / "peg.yaml"
COARSE = Settings(horizon=60.0, tolerance=1e-6)
STARTS = [{"phase": phase, "gripper_tilt": 0.001} for phase in (0.0, 2.0, 4.0)]


def peg(**tolerances):
    quantities = load_device(PEG).quantities
    texts = {name: f"{quantities[name]!r} {text}" for name, text in tolerances.items()}
    return load_device(PEG, texts)


def test_distributions_have_the_stated_width_and_are_not_cut_off():
    law = distribution(10.0, Tolerance("uniform", 0.05, relative=True))
    assert law.support() == pytest.approx((9.5, 10.5))
    law = distribution(0.05, Tolerance("normal", 0.05))
    assert (law.mean(), law.std()) == pytest.approx((0.05, 0.05))
    assert distribution(0.9, Tolerance("uniform", 0.3)).support() == pytest.approx((0.6, 1.2))


@pytest.mark.parametrize(
    ("name", "text", "share"),
    [
        ("clearance", "0.06 σ 0.06", 0.1587),  # below 0: Φ(-1)
        ("friction", "0.1 ± 0.2", 0.25),
        ("restitution", "0.9 ± 0.2", 0.25),
        ("press_force", "5 N σ 5 N", 0.1587),
    ],
)
def test_devices_that_cannot_be_count_as_not_going_in_and_are_said(name, text, share, capsys):
    changes = {"misalignment": "2 mm", "contact_stiffness": "300 kN/m", name: text}
    stated = load_device(PEG, changes)
    found, results = yield_of(stated, STARTS[:1], COARSE, devices=256, indices=False)
    assert found.impossible == pytest.approx(found.devices * share, abs=4)
    assert not (results.goes_in & results.impossible).any()
    assert found.share <= 1.0 - found.impossible / found.devices
    sets = [word for each in changes.items() for word in ("--set", "=".join(each))]
    given = ["assess", "--device", str(PEG), *sets, "--horizon", "1 ms", "--devices", "64"]
    assert cli.main(given) == cli.DONE
    assert "count as not going in" in capsys.readouterr().out


def test_devices_are_drawn_within_their_tolerances():
    values = drawn(peg(friction="± 0.05", press_force="σ 1"), 1024, seed=3)
    assert values["friction"].mean() == pytest.approx(0.15, abs=1e-3)
    assert np.ptp(values["friction"]) == pytest.approx(0.1, rel=0.01)
    assert values["press_force"].std() == pytest.approx(1.0, rel=0.02)
    again = drawn(peg(friction="± 0.05", press_force="σ 1"), 1024, seed=3)
    assert all((values[name] == again[name]).all() for name in values)


def test_sobol_indices_of_the_ishigami_function():
    # T. Ishigami, T. Homma, 1990: sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1 on (-π, π)³
    x1, x2, x3 = np.moveaxis(np.pi * (2.0 * sobol_cubes(3, 4096, seed=1) - 1.0), -1, 0)
    total = total_indices(np.sin(x1) + 7.0 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1))
    a, b = 7.0, 0.1
    alone = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, 0.0
    mixed = b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    shares = np.array([alone[0] + mixed, alone[1], mixed]) / (sum(alone) + mixed)
    assert total == pytest.approx(shares, abs=0.02)
    assert np.isnan(total_indices(np.ones((5, 8)))).all()
    one = np.random.default_rng(0).random((2, 4096))  # of one quantity: never above 1
    assert total_indices(one)[0] == pytest.approx(1.0, abs=0.05)
    assert total_indices(one)[0] <= 1.0
    assert np.isnan(total_indices(np.eye(2, 16)[:, ::-1])).all()  # one failure of 16: not known


def test_the_interval_of_a_share_is_wilsons():
    low, high = interval(90, 100)
    assert (low, high) == pytest.approx((0.8256, 0.9448), abs=1e-4)  # E. B. Wilson, 1927
    assert interval(64, 64)[1] == 1.0


def oracle(monkeypatch, fails):
    def run(_, values, *_settings):
        count = len(next(iter(values.values())))
        bad = fails(values)
        times = np.where(bad, np.nan, 0.1 + np.arange(count))
        failing, no = np.where(bad, 1, -1), np.zeros(count, bool)
        return DeviceResults(
            values, ~bad, times, times[:, None], times, times, failing, {}, no, times, no, no
        )

    monkeypatch.setattr(yields, "run_devices", run)


def test_the_quantity_that_fails_is_to_blame(monkeypatch):
    stated = peg(friction="± 0.05", press_force="± 1", misalignment="± 10 %")
    oracle(
        monkeypatch, lambda v: (v["friction"] - 0.15) / 0.05 + 0.2 * (v["press_force"] - 10) > 0.8
    )
    found, _ = yield_of(stated, STARTS, COARSE, devices=512)
    assert found.low < 0.9 < found.high  # of u + 0.2 v > 0.8 on (-1, 1)²: a tenth
    assert found.sobol_indices[0].quantity == "friction"
    assert found.sobol_indices[0].failure > 0.8


@pytest.mark.parametrize(
    ("most", "required", "expected"),
    [(0.0, None, 64), (0.4, None, 1024), (0.4, 0.4, 4096), (0.99, None, 4096), (1.0, None, 4096)],
)
def test_fewer_devices_tell_that_a_yield_is_poor(monkeypatch, most, required, expected):
    """By Wilson's interval: 5.7 % wide for 0 of 64, 12 % for 40 % of 256, 6 % of 1,024."""
    stated = peg(friction="± 0.05")
    oracle(monkeypatch, lambda v: v["friction"] > 0.1 + 0.1 * most)
    found, results = yield_of(stated, STARTS, COARSE, indices=False, required=required)
    assert found.devices == len(results.goes_in) == expected
    assert found.share == pytest.approx(most, abs=0.02)
    assert found.runs == expected * 3


def test_too_few_failures_blame_no_tolerance(monkeypatch):
    stated = peg(friction="± 0.05", press_force="± 1")
    oracle(monkeypatch, lambda v: v["friction"] > 0.1999)
    found, _ = yield_of(stated, STARTS, COARSE, devices=4096)
    assert 0 < found.devices - found.going_in < 10
    assert found.blame.startswith("too few of one kind to blame a tolerance: ")
    assert all(not each.failure > 1.0 for each in found.sobol_indices)
    oracle(monkeypatch, lambda v: v["friction"] > 0.18)
    found, _ = yield_of(stated, STARTS, COARSE, devices=512)
    assert found.blame.startswith("of failures: friction ")


def test_the_nearest_device_that_fails_is_by_its_largest_deviation_in_tolerances():
    stated = peg(friction="± 0.05", press_force="σ 1")
    # In tolerances: (0.2, 0.1) goes in; (0.8, 0.1), (0.4, 0.6) and (0.1, 1.2) do not.
    values = {
        "friction": np.array([0.16, 0.19, 0.17, 0.145]),
        "press_force": np.array([10.3, 9.7, 11.8, 13.6]),
    }
    goes_in, none = np.array([True, False, False, False]), np.zeros(4)
    failing = np.array([-1, 0, 2, 1])
    no = np.zeros(4, bool)
    known = DeviceResults(
        values, goes_in, none, none[:, None], none, none, failing, {}, no, none, no, no
    )
    found = nearest_failing(stated, known, STARTS)
    assert found.quantities == {"friction": 0.17, "press_force": 11.8}
    assert found.distance == pytest.approx(0.6)
    assert found.start == STARTS[2]


def test_no_device_is_named_where_nothing_fails(monkeypatch):
    stated = peg(friction="± 0.05")
    oracle(monkeypatch, lambda v: v["friction"] > 1.0)
    found, known = yield_of(stated, STARTS, COARSE, devices=16)
    assert (found.share, found.high) == (1.0, 1.0)
    assert np.isnan(found.sobol_indices[0].failure)
    assert nearest_failing(stated, known, STARTS) is None


@pytest.mark.usefixtures("_no_leeways")
def test_the_nearest_failing_device_of_the_peg_fails_when_its_command_is_run(capsys):
    device = ["--device", str(PEG)]
    device += ["--set", "friction=0.15 ± 0.08", "--set", "contact_stiffness=3e5"]
    rough = ["--horizon", "600 ms", "--tolerance", "1e-6"]
    assert cli.main(["assess", "--details", *device, *rough, "--devices", "16"]) == cli.DONE
    lines = capsys.readouterr().out.splitlines()
    assert any(e.startswith("fails nearest") and "% of the tolerances" in e for e in lines)
    place = lines.index("nearest failing device:")
    command = shlex.split(lines[place + 1])
    assert cli.main([*command[1:], *rough]) == cli.DONE
    assert "does not align" in capsys.readouterr().out


def test_a_yield_needs_tolerances_and_a_power_of_two():
    with pytest.raises(ValueError, match="no quantity has a tolerance"):
        yield_of(load_device(PEG), STARTS, COARSE)
    with pytest.raises(ValueError, match="must be a power of two"):
        yield_of(peg(friction="± 0.05"), STARTS, COARSE, devices=100)
