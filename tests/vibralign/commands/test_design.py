"""``vibralign design``: output, files and refusals."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

import vibralign
from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings, load_device
from vibralign.answers import design_trials
from vibralign.answers.cases import cases_of
from vibralign.answers.design import DEVICES, GENERATIONS, POPULATION
from vibralign.answers.reliability import run_devices
from vibralign.answers.yields import drawn
from vibralign.commands import main as cli

PEG = Path(__file__).parents[2] / "square" / "peg.yaml"
QUICK = ["--generations", "1", "--population", "5", "--devices", "64"]
BASE = ["--horizon", "600 ms", "--set", "contact_stiffness=300 kN/m"]


@pytest.fixture
def peg(tmp_path, monkeypatch):
    monkeypatch.setattr(design_trials, "POINTS", 4)  # devices and lines of the quick trial

    def write(limits, friction="0.15"):
        path = tmp_path / "peg.yaml"
        more = f"free: {{tilt_stiffness: 0.2 to 0.4 N m/rad}}\nlimits: {{{limits}}}\n"
        text = PEG.read_text(encoding="utf-8").replace("friction: 0.15", f"friction: {friction}")
        text = text.replace("tilt_stiffness: 0.5", "tilt_stiffness: 1.2")  # does not go in
        path.write_text(text + more, encoding="utf-8")
        return str(path)

    return write


def test_a_design_is_recommended(capsys, peg):
    given = ["design", "--device", peg("contact_force: 60 N"), *QUICK, *BASE]
    assert cli.main(given) == cli.DONE
    said = capsys.readouterr().out
    assert said.startswith("recommended            tilt_stiffness = 0.")
    assert "largest contact_force" in said
    assert re.search(r"  of the force +edge [\d.]+ N, corner .*, until inserted\n", said)
    words = "reliable at the stated values; yield 100 % (94.3 % to 100 %, 95 % confidence)"
    assert f"verdict                {words} under the tolerances\n" in said  # 64 / (64 + 1.96²)
    assert re.search(r"largest time +[\d.]+ m?s until alignment\n", said)
    assert (
        "  tolerances  none stated, so assumed: press_force ± 10 %, tilt_stiffness ± 10 %" in said
    )
    assert cli.main([*given, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert (record["feasible"], record["devices"], record["yield_confidence"]) == (True, 64, 0.95)
    assert record["yield_interval"] == pytest.approx([0.9434, 1.0], abs=1e-4)
    assert "so assumed: press_force" in record["assumptions"]["tolerances"]
    assert record["time"] < 0.6  # the horizon


def test_python_has_the_design_of_the_command(capsys, peg):
    """The recommended setting and its numbers; the defaults of the search are the same, too."""
    path = peg("contact_force: 60 N", friction="0.15 ± 0.03")
    assert cli.main(["design", "--device", path, *QUICK, *BASE, "--json"]) == cli.DONE
    said = json.loads(capsys.readouterr().out)
    device = replace(load_device(path, {"contact_stiffness": "300 kN/m"}), horizon=0.6)
    found = vibralign.design(device, generations=1, population=5, devices=64)
    assert isinstance(found, vibralign.Design)
    assert (found.setting, found.feasible) == (said["setting"], said["feasible"])
    assert found.check.forces == said["forces"]
    assert [*found.interval] == said["yield_interval"]
    shown = found._shown()
    for name in ("margin", "time", "contact_force", "tilt", "devices"):
        assert shown[name] == said[name]
    [(name, value)] = found.setting.items()
    assert repr(found) == f"<Design: recommended {name} = {value:.4g} N m/rad>"
    assert f"<tr><th>{name}</th><td>{value:.7g}</td></tr>" in found._repr_html_()
    parser = cli.parser().parse_args(["design", "--device", path])
    assert (int(parser.generations), int(parser.population)) == (GENERATIONS, POPULATION)
    assert int(parser.devices) == DEVICES
    with pytest.raises(ValueError, match=r"devices = 3: .* power of two"):
        vibralign.design(path, devices=3)
    with pytest.raises(ValueError, match="nothing is free"):
        vibralign.design(PEG)


@pytest.mark.usefixtures("_no_leeways")
def test_assess_says_of_the_recommended_setting_what_design_says(capsys, peg):
    device = peg("time: 0.2 s, contact_force: 60 N", friction="0.15 ± 0.03")
    assert cli.main(["design", "--device", device, *QUICK, *BASE, "--json"]) == cli.DONE
    designed = json.loads(capsys.readouterr().out)
    [(name, value)] = designed["setting"].items()
    assert value == float(f"{value:.4g}")  # as it is printed
    given = ["--devices", "64", "--json", *BASE, "--set", f"{name}={value!r}"]
    assert cli.main(["assess", "--device", device, *given]) == cli.DONE
    assessed = json.loads(capsys.readouterr().out)
    assert designed["verdict"] == assessed["verdict"]
    assert designed["yield_interval"] == [assessed["yield"]["low"], assessed["yield"]["high"]]
    assert designed["yield_confidence"] == assessed["yield"]["confidence"] == 0.95
    assert designed["forces"] == assessed["yield"]["forces"]
    # As the runs of Python have it: no place is pressed by more than the limit.
    stated = load_device(device, {"contact_stiffness": 3e5, name: value})
    settings = Settings(scene=INSERTION, tolerance=1e-6, horizon=0.6 / stated.units.time)
    runs = run_devices(stated, drawn(stated, 64), cases_of(stated, Ensemble()), settings)
    assert designed["contact_force"] == runs.force.max() <= 60.0
    assert designed["forces"] == {place: each.max() for place, each in runs.forces.items()}


def test_limits_that_cannot_be_kept_exit_with_1(capsys, peg):
    assert cli.main(["design", "--device", peg("contact_force: 8 N"), *QUICK, *BASE]) == cli.FAILED
    said = capsys.readouterr().out
    assert said.startswith("no setting of those tried keeps the limits")
    assert re.search(r"exceeds the limit of contact_force \([\d.]+ N > 8 N\)\n", said)
    assert re.search(r"limits +contact_force [\d.]+ N > 8 N: exceeded\n", said)
    assert "what limits it:\n  the limit of contact_force, exceeded\n" in said


def test_the_nearest_setting_names_the_limits_that_it_passes(capsys, peg):
    device = peg("time: 60 ms", friction="0.3 ± 0.29")
    assert cli.main(["design", "--device", device, *QUICK, *BASE]) == cli.FAILED
    said = capsys.readouterr().out
    words = "goes in and keeps the limits with all devices within the tolerances"
    assert said.startswith(f"no setting of those tried {words}\nnearest to it ")
    nearest = re.search(
        r"(\d+) of 64 drawn devices go in; exceeds the limit of time \((.*) > 60 ms\)\n",
        said,
    )
    assert f"largest time           {nearest[2]} until alignment" in said
    limits = said.partition("what limits it:\n")[2].splitlines()
    assert limits[0] == "  the limit of time, exceeded"
    assert "  the tolerance of friction" in limits


def test_a_device_that_goes_in_nowhere_is_told_the_cause_and_that_no_range_helps(capsys, peg):
    device = peg("time: 0.5 s", friction="0.9 ± 0.1")
    assert cli.main(["design", "--device", device, *QUICK, *BASE]) == cli.FAILED
    said = capsys.readouterr().out
    assert "cause                  it hardly slips: it sticks on the edge " in said
    words = "not reliable at the stated values; no others within the tolerances were tried"
    assert f"verdict                {words}\n" in said
    assert "tolerances  as stated: friction ± 0.1\n" in said
    assert not re.search(r"nan|none|of 0 times|by 0 devices", said.replace("none drawn", ""))
    setting = re.search(r"nearest to it +tilt_stiffness = ([\d.]+) ", said)[1]
    command = (
        f"--device {device} --set 'contact_stiffness=300 kN/m' --set 'tilt_stiffness={setting}"
    )
    assert f"next                   see what to change: vibralign assess {command} N m/rad'" in said
    assert "  the device itself: as stated it does not go in\n" in said
    for end in (
        "upper end of the range of tilt_stiffness, 0.4",
        "lower end of the range of tilt_stiffness, 0.2",
    ):
        assert f"  the {end} N m/rad\n" in said
