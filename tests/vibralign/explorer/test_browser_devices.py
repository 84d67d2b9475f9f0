"""Pages of devices in a real browser: units, refusals, commands, files, horizon."""

import json
import math
import os
import re
import time
from dataclasses import replace
from pathlib import Path

import pytest

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome
from model.runs.simulate import simulate_once
from study.config import load_study, study_path
from tests.vibralign.explorer.browser import find_browser
from vibralign import load_device
from vibralign.commands import main as cli
from vibralign.device.amounts import read_amount
from vibralign.device.quantities import unit_of

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(not find_browser(), reason="no Chromium is installed; CHROMIUM names one"),
]
PEG = Path(__file__).parents[2] / "square" / "peg.yaml"
LOWERED = Path(__file__).parents[3] / "docs" / "peg.yaml"
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
    saved = tmp_path / started.evaluate("fileOf(explorer.state, MODEL)")
    assert saved.stem == name
    saved.write_text(started.evaluate("deviceOf({...explorer.state, vibration: true}, MODEL)"))
    still = ["--set", "frequency=0"] if "vibration=off" in address else []
    command = ["simulate", "--scene", "insertion", "--device", str(saved), *still]
    assert cli.main([*command, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    device = load_device(saved, {"frequency": 0.0} if still else {})
    assert record["outcome"] == Outcome(started.results["outcome"]).name.lower()
    if record["tau_align"] is not None:  # the command refines its run
        seconds = started.results["tau_align"] * device.units.time
        assert record["tau_align"] == pytest.approx(seconds, rel=1e-6)
    once = simulate_once(device.parameters, device.run_settings(SETTINGS, device.units))
    aligned = started.results["tau_align"] or math.nan
    assert once.tau_align == pytest.approx(aligned, rel=1e-8, nan_ok=True)
    force = re.search(r"Largest force at one place: ([\d.]+) N(?:, at each tip [\d.]+ N)?, "
                      r"from this start, (.*?)\.( |$)", started.text("words"))  # fmt: skip
    assert float(force[1]) == pytest.approx(record["contact_force_max"], rel=5e-3)
    assert force[2] == record["forces_known"]
    # The unvibrated run ends in the words of the command.
    assert cli.main(command) == cli.DONE
    words = capsys.readouterr().out.partition("without vibration: ")[2].partition("\n")[0].strip()
    said = started.text("words") + started.text("beside")
    assert f"ithout vibration it {words}" in said
    falls = started.evaluate("inShape(contactWords({mode_dropped: 1}))")
    assert falls == f"falls into the {'hole' if device.shape == 'round' else 'slot'}"
    assert started.errors == []


@pytest.mark.parametrize("stated", ["vibrator=still", "approach_speed=sudden", "vibrator=running"])
def test_a_saved_device_is_lowered_as_the_page_shows(started, tmp_path, stated):
    page, saved = tmp_path / "peg.html", tmp_path / "peg.yaml"
    command = ["explore", "--device", str(LOWERED), "--set", stated, "--out", str(page)]
    assert cli.main(command) == cli.DONE
    started.show(f"{page.as_uri()}#t=0")
    saved.write_text(started.evaluate("deviceOf(explorer.state, MODEL)"))
    again, device = load_device(saved), load_device(LOWERED).changed(**dict([stated.split("=")]))
    settings = [each.run_settings(SETTINGS, each.units) for each in (again, device)]
    assert settings[0].start == settings[1].start
    assert again.parameters.approach_speed == device.parameters.approach_speed
    assert started.errors == []


@pytest.mark.parametrize(
    "name", ["<!--<script>.yaml", "@script@ @model@.yaml", "ü'\"&amp;\n.yaml", b"\xff.yaml"]
)
def test_a_file_with_an_odd_name_has_a_page_that_runs(started, tmp_path, name):
    device, page = tmp_path / os.fsdecode(name), tmp_path / "page.html"
    device.write_bytes(LOWERED.read_bytes())
    assert cli.main(["explore", "--device", str(device), "--out", str(page)]) == cli.DONE
    started.show(f"{page.as_uri()}#t=0")
    assert "Aligned" in started.text("verdict")
    assert started.errors == []
    if isinstance(name, str):
        title = started.evaluate("document.title")
        assert " ".join(device.name.split()) in title


def test_a_swipe_scrolls_and_changes_no_device(started, device_urls):
    with started.touched():
        started.show(f"{device_urls['peg']}#t=0", 400, 800)
        started.wait_for("explorer.map")
        before = started.evaluate("explorer.state.values")
        for name in ("map", "plots", "scene", "s-press_force"):
            started.evaluate(f"element('{name}').scrollIntoView({{block: 'center'}})")
            top, *place = started.evaluate(
                f"(() => {{ const b = element('{name}').getBoundingClientRect();"
                "return [scrollY, b.left + 0.7 * b.width, b.top + b.height / 2]; })()"
            )
            started.swipe(*place, -150)
            assert abs(started.evaluate("scrollY") - top) > 100, name
            assert started.evaluate("explorer.state.values") == before, name
        started.evaluate("element('map').scrollIntoView({block: 'center'})")
        started.tap(*started.evaluate(
            "(() => { const b = element('map').getBoundingClientRect();"
            "return [b.left + 0.7 * b.width, b.top + 0.3 * b.height]; })()"
        ))  # fmt: skip
        after = started.evaluate("explorer.state.values")
    changed = {name for name in after if after[name] != before[name]}
    assert changed == {started.evaluate("explorer.state.x"), started.evaluate("explorer.state.y")}
    assert started.errors == []


@pytest.mark.parametrize("name", ["press_force", "half_width", "contact_stiffness", "clearance"])
def test_a_number_is_in_the_unit_that_is_shown(started, device_urls, name):
    if started.evaluate("location.href").partition("#")[0] != device_urls["shaft"]:
        started.show(device_urls["shaft"])
    unit = started.evaluate(f"parameters[{json.dumps(name)}].unit")
    for given in ("12.5", f"12.5 {unit}"):
        read = started.evaluate(f"readAmount(parameters[{json.dumps(name)}], {json.dumps(given)})")
        expected = read_amount(name, f"12.5 {unit}".strip(), unit_of(name)).value
        assert read == {"value": pytest.approx(expected, rel=1e-12), "message": ""}
    for given in ("12.5 kN/m²", "15,000", "1 500", "1'500", "12.5 %"):
        read = started.evaluate(f"readAmount(parameters[{json.dumps(name)}], {json.dumps(given)})")
        assert "must be a number" in read["message"]


def test_a_device_is_refused_as_by_the_command(started, device_urls, capsys):
    started.show(device_urls["peg"])
    wrong = {"half_width": "50 mm", "press_force": "0 N"}
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


def test_without_scripts_a_page_says_so(started, device_urls):
    started.scripts(allowed=False)
    try:
        started.open(device_urls["peg"])
        shown_text = "document.body?.innerText ?? ''"
        while "needs JavaScript" not in (shown := started.evaluate(shown_text)):
            time.sleep(0.05)
        assert "which is off or not allowed here" in shown
        assert "Copy link" not in shown  # no control that does nothing
    finally:
        started.scripts(allowed=True)
