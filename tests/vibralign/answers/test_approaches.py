"""Approaches of a device: stated, refused, tried where they are not stated, and asked each way."""

import json
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Reason
from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings, load_device, reliable_at, sweep
from vibralign.answers.approaches import in_worst_approach, worst_of
from vibralign.answers.assess import assess
from vibralign.answers.cases import approach_of, cases_of, without_approach
from vibralign.answers.reliability import from_every_start
from vibralign.answers.verdicts import verdicts_on
from vibralign.commands import main as cli
from vibralign.device.approach import Approach

PEG = Path(__file__).resolve().parents[3] / "docs" / "devices" / "peg.yaml"
FEW = Ensemble(phases=2, tilts=[1.0], every=1)
SETTINGS = Settings(scene=INSERTION, tolerance=1e-6, horizon=100.0)


def changed(**lines: object):
    return load_device(PEG, lines)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ({"approach_speed": "sudden"}, []),
        ({"approach_speed": "20 mm/s", "vibrator": "still"},
         ["still until pressed and at rest, 20 mm/s"]),
        ({"approach_speed": "20 mm/s"},
         ["running, 20 mm/s", "still until pressed and at rest, 20 mm/s"]),
        ({"vibrator": "running"},
         [f"running, {each} mm/s" for each in (10, 100, 30, 3)]),
        ({}, [*(f"running, {each} mm/s" for each in (10, 100, 30, 3)),
              "still until pressed and at rest, 10 mm/s"]),
    ],
)  # fmt: skip
def test_what_is_not_stated_is_tried(lines, words):
    device = changed(**lines)
    assert [str(each) for each in device.approaches()] == words
    approaches = dict.fromkeys(approach_of(case) for case in cases_of(device, FEW))
    assert len(approaches) == max(len(words), 1)


def test_the_speed_of_a_sudden_start_cannot_vary():
    device = changed(approach_speed="sudden")
    for ask in (sweep, reliable_at):
        with pytest.raises(ValueError, match="cannot vary with approach_speed: sudden"):
            ask(device, approach_speed=[0.005, 0.01])


def test_the_speed_is_that_of_the_file_in_the_units_of_each_device():
    device = changed(approach_speed="20 mm/s", vibrator="running")
    units = device.units
    assert device.parameters.approach_speed == pytest.approx(0.02 / units.amplitude * units.time)
    faster = device.changed(approach_speed=0.04)
    assert faster.parameters.approach_speed == pytest.approx(2 * device.parameters.approach_speed)
    sudden = changed(approach_speed="20 mm/s").changed(approach_speed="sudden")
    assert sudden.parameters.approach_speed is None
    assert sudden.run_settings(SETTINGS, units).start == "simultaneous"


def test_cases_run_as_devices_that_state_their_approach():
    device = changed(gripper_tilt=0.0)
    cases = [*cases_of(device, FEW)]
    own = {"mass": np.array([0.9, 1.0]) * device.quantities["mass"]}
    found, _ = from_every_start(device, own, cases, SETTINGS)
    for place in (0, 3, len(cases) - 1):
        lowered = device.lowered(approach_of(cases[place]))
        alone, _ = from_every_start(lowered, own, [without_approach(cases[place])], SETTINGS)
        for name in ("outcome", "tau_align", "contact_force_max"):
            np.testing.assert_array_equal(found[name][:, place], alone[name][:, 0])


def test_assess_has_a_line_for_each_and_one_verdict():
    device = changed(gripper_tilt=0.0)
    result = assess(device, SETTINGS, FEW, vary=False)
    assert [each.of for each in result.approaches] == list(device.approaches())
    assert sum(each.starts for each in result.approaches) == result.starts
    assert result.reliable == all(each.reliable for each in result.approaches)
    assert result.worst == worst_of(result.approaches)
    assert in_worst_approach(device, SETTINGS, FEW) == device.lowered(result.worst)
    for each in result.approaches:
        alone = assess(device.lowered(each.of), SETTINGS, FEW, vary=False)
        assert (alone.aligned, alone.tau_worst) == (each.aligned, each.tau_worst)
        assert alone.contact_force_max == each.force_most
    struck = max(each.force_most for each in result.approaches)
    sudden = assess(changed(gripper_tilt=0.0, approach_speed="sudden"), SETTINGS, FEW, vary=False)
    assert struck > 2.0 * sudden.contact_force_max


@pytest.mark.usefixtures("_no_leeways")
def test_assess_says_every_approach_where_devices_are_drawn_in_the_worst(capsys):
    device = ["--device", str(PEG), "--devices", "16"]
    rough = ["--tolerance", "1e-6", "--horizon", "0.2 s", "--json"]
    cli.main(["assess", *device, *rough, "--set", "approach_speed=30 mm/s"])
    start = json.loads(capsys.readouterr().out)["assumptions"]["start"]
    assert start.startswith("each of running, 30 mm/s; still")


def test_the_press_alone_is_counted():
    device = changed(
        approach_speed="30 mm/s", vibrator="still", friction=0.02, press_force="15 N",
        gripper_tilt="0.2 deg",
    )  # fmt: skip
    cases = [{**case, "vibrates": 0.0, "approach_speed": 0.03} for case in cases_of(device, FEW)]
    found, _ = from_every_start(device, {"friction": np.array([0.02])}, cases, SETTINGS)
    assert (found["reason"] == Reason.BY_PRESS).all()
    results = {name: each[0] for name, each in found.items()}
    [verdict] = verdicts_on([*map(approach_of, cases)], cases, results)
    assert verdict.of == Approach("still", 0.03)
    assert verdict.by_press == verdict.aligned == len(cases)
