"""Pages of devices in a real browser: units, refusals, commands, files, horizon."""

import json
import re
import shlex
import time
from dataclasses import replace
from pathlib import Path

import pytest

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome
from study.config import load_study, study_path
from tests.vibralign.explorer.browser import find_browser
from vibralign.commands import main as cli
from vibralign.device.amounts import read_amount
from vibralign.device.stated import unit_of

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(not find_browser(), reason="no Chromium is installed; CHROMIUM names one"),
]
PEG = Path(__file__).parents[2] / "square" / "peg.yaml"
SETTINGS = replace(load_study(study_path()).settings.settings, scene=INSERTION)


@pytest.mark.parametrize(
    ("name", "address"),
    [
        ("shaft", "t=0"),
        ("shaft", "press_force=18"),  # its contact stiffness is of materials and press force
        ("shaft", "press_force=18&amplitude=0.0004&misalignment=0.0005"),
        ("pin", "vibration=off"),
        ("peg", "mass=0.4&axial_stiffness=2500&clearance=0.05"),
    ],
)
def test_a_device_and_its_command_agree(started, device_urls, name, address, tmp_path, capsys):
    started.open(f"{device_urls[name]}#{address}")
    started.wait_for("window.explorer && element('beside').textContent")
    command = shlex.split(started.evaluate("commandOf(explorer.state, MODEL)"))
    saved = tmp_path / started.evaluate("fileOf(explorer.state, MODEL)")
    assert saved.stem == name
    saved.write_text(started.evaluate("deviceOf({...explorer.state, vibration: true}, MODEL)"))
    still = ["--set", "frequency=0"] if "vibration=off" in address else []
    for arguments in (command[1:], [*command[1:4], "--device", str(saved), *still]):
        assert cli.main([*arguments, "--json"]) == cli.DONE
        record = json.loads(capsys.readouterr().out)
        assert record["outcome"] == Outcome(started.results["outcome"]).name.lower()
        if record["tau_align"] is not None:
            expected = pytest.approx(started.results["tau_align"], rel=1e-8)
            assert record["tau_align"] == expected
    force = re.search(r"Largest force at one point: ([\d.]+) N, from this start, (.*?)\.( |$)",
                      started.text("words"))  # fmt: skip
    assert float(force[1]) == pytest.approx(record["si"]["contact_force_max_N"], rel=5e-3)
    assert force[2] == record["forces_known"]
    # The unvibrated run ends in the words of the command.
    assert cli.main(command[1:]) == cli.DONE
    words = capsys.readouterr().out.partition("without vibration: ")[2].partition("\n")[0].strip()
    said = started.text("words") + started.text("beside")
    assert f"ithout vibration it {words}" in said
    assert started.errors == []


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("press_force", "12 N"), ("press_force", "80mN"), ("half_width", "5 mm"),
        ("half_width", "60 um"), ("half_width", "0.6 µm"), ("contact_stiffness", "48 MN/m"),
        ("lateral_stiffness", "3 kN/m"), ("frequency", "3000 rpm"), ("frequency", "314 rad/s"),
        ("inertia", "350 kg mm²"), ("inertia", "450 g cm^2"), ("initial_tilt", "3°"),
        ("initial_tilt", "3 deg"), ("tilt_damping", "4 mN m s/rad"), ("clearance", "4 %"),
        ("mass", "2 g"), ("amplitude", "1e-1 mm"), ("mass", "2 Kg"), ("frequency", "60 hz"),
        ("tilt_stiffness", "6 Nm/rad"), ("tilt_stiffness", "6 N-m"), ("axial_damping", "6 Ns/m"),
        ("axial_stiffness", "100 lb/in"), ("inertia", "120 kgmm²"), ("inertia", "450 g cm2"),
        ("rest_tilt", "\u22123 deg"), ("half_width", "30 mil"), ("tilt_damping", "4 mNms/rad"),
        ("press_force", "3 lb"), ("mass", "3 lb"), ("frequency", "50 s-1"), ("mass", "15\u202f"),
        ("inertia", "120 kg mm**2"), ("half_height", "0.4 in"),
    ],
)  # fmt: skip
def test_units_are_read_as_in_a_device_file(started, device_urls, name, given):
    if started.evaluate("location.href").partition("#")[0] != device_urls["shaft"]:
        started.show(device_urls["shaft"])
    read = started.evaluate(f"readAmount(parameters[{json.dumps(name)}], {json.dumps(given)})")
    assert read["message"] == ""
    expected = read_amount(name, given, unit_of(name)).value
    assert read["value"] == pytest.approx(expected, rel=1e-12)


def test_a_device_is_refused_as_by_the_command(started, device_urls, capsys):
    started.show(device_urls["peg"])
    wrong = {"half_width": "50 mm", "press_force": "0 N", "friction": "1 mm", "mass": "1 foo"}
    wrong |= {"clearance": "0,1", "tilt_stiffness": "3 constructor"}
    for name, given in wrong.items():
        started.evaluate(f"open(''); take({{{name}: {json.dumps(given)}}})")
        said = started.text("fault").partition(": ")[2]
        command = ["simulate", "--device", str(PEG), "--set", f"{name}={given}"]
        assert cli.main(command) == cli.REFUSED
        refusal = capsys.readouterr().err
        # From the name of the quantity on: which value it is, then the rule.
        assert said.partition(" = ")[0] in refusal
        rule = said.partition(": ")[2]
        assert rule[:12] in refusal, (said, refusal)


@pytest.mark.parametrize("given", ["15,000 mN", "1,234.5 mN", "1 500 mN", "1.234,5 N", "1'500 mN"])
def test_grouped_digits_are_refused_as_by_the_command(started, device_urls, given):
    if started.evaluate("location.href").partition("#")[0] != device_urls["shaft"]:
        started.show(device_urls["shaft"])
    read = started.evaluate(f"readAmount(parameters.press_force, {json.dumps(given)})")
    with pytest.raises(ValueError, match="write") as refusal:
        read_amount("press_force", given, "N")
    assert read["message"].partition(": ")[2] == str(refusal.value).partition(": ")[2]


@pytest.mark.parametrize("name", ["mass", "axial_stiffness"])
def test_a_horizon_in_seconds_holds_in_other_units_of_time(started, tmp_path, name):
    file, seconds = tmp_path / "peg.html", 0.09  # the peg aligns after 97 ms
    device = ["--device", str(PEG), "--horizon", f"{seconds} s"]
    assert cli.main(["explore", *device, "--out", str(file)]) == 0
    value = {"mass": 0.9, "axial_stiffness": 1200.0}[name]
    started.show(f"{file.as_uri()}#{name}={value}&x={name}&t=0")
    end = "explorer.run.track.time.at(-1) * scaleOf(MODEL.time, explorer.state.values)"
    assert started.evaluate(end) == pytest.approx(seconds, rel=1e-12)
    assert started.errors == []


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("delete window.WebAssembly", "runs no WebAssembly here: no runs are computed"),
        ("WebAssembly.instantiate = () => Promise.reject(new Error('policy'))", "(policy)"),
        ("delete window.DecompressionStream", "no runs are computed"),
        ("window.Worker = function () { throw new Error('none'); }", "starts no Worker: no map is"),
    ],
)
def test_what_a_browser_does_not_allow_is_said(started, device_urls, script, words):
    with started.beginning_with(script):
        started.open(device_urls["peg"])
        started.wait_for("document.getElementById('stuck')?.textContent")
        assert words in started.text("stuck")
        assert started.evaluate("document.getElementById('p-press_force').value") == "6"
    started.show(device_urls["peg"])
    assert started.text("stuck") == ""


def test_without_scripts_a_page_says_so_and_shows_the_device(started, device_urls):
    started.scripts(allowed=False)
    try:
        started.open(device_urls["peg"])
        shown_text = "document.body?.innerText ?? ''"
        while "needs JavaScript" not in (shown := started.evaluate(shown_text)):
            time.sleep(0.05)
        assert "which is off or not allowed here" in shown
        assert "initial pressing force\t6\tN" in shown
        assert "Copy link" not in shown  # no control that does nothing
    finally:
        started.scripts(allowed=True)
