"""``vibralign assess``: output, its units, and refusals."""

import json
from pathlib import Path

import pytest

from model.cli import main as cli
from model.study import assessment
from model.study.assessment import Assessment, Leeway
from model.study.devices import load_device

PEG = str(Path(__file__).parents[2] / "docs" / "peg.yaml")
COARSE = ["--horizon", "60", "--tolerance", "1e-6"]
IN_SECONDS = ["--horizon", "600 ms", "--tolerance", "1e-6"]  # of the peg: 60 of its units


def assess(*arguments: str) -> int:
    return cli.main(["assess", *arguments])


def test_a_device_in_si_units_is_assessed_in_si_units(capsys):
    assert assess("--device", PEG, *IN_SECONDS) == cli.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["reliable", "aligns", "from", "32", "of", "32", "starts"]
    assert " s, by the start" in lines[1]
    force = next(line for line in lines if "press_force" in line)
    assert force.endswith("its value 10 N")


def test_json_holds_everything_in_the_units_of_the_device(capsys, monkeypatch):
    units, device = load_device(Path(PEG), {})
    leeway = Leeway("press_force", device.press_force, 1.0, 5.0, False, True)
    found = Assessment(
        starts=32, aligned=32, tau_best=2.0, tau_worst=3.0, failing_start=None, leeways=(leeway,)
    )
    monkeypatch.setattr(assessment, "assess", lambda *_, **__: found)
    assert assess("--device", PEG, "--json") == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["units"] == "SI"
    assert record["tau_worst"] == pytest.approx(3.0 * units.time)
    assert record["leeways"][0]["value"] == pytest.approx(10.0)
    assert record["leeways"][0]["high"] == pytest.approx(5.0 * units.force)
    assert record["unvibrated"] == "rests"
    assert 0.0 < record["slow_tilt"] < record["unvibrated_tilt"] < 0.2
    assert assess("--json") == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert (record["units"], record["tau_worst"]) == ("1", 3.0)
    assert record["leeways"][0]["high"] == 5.0


def test_a_failing_start_is_named_with_a_remedy(capsys):
    assert assess(*COARSE, "--set", "tilt_stiffness=2", "--set", "press_force=8") == cli.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("not reliable    aligns from 0 of 32 starts")
    assert lines[1].startswith("without vibration: ")
    assert lines[2].startswith("for example     phase = 0, initial_tilt = 0.001: ")
    assert lines[3].startswith("what to do")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--device", "no.yaml"], "no.yaml: cannot be read: No such file"),
        (["--device", PEG, "--set", "mass=0"], "mass = 0.0: must be a finite number > 0"),
        (["--set", "fricton=0.1"], "Did you mean 'friction'?"),
        (["--horizon", "-1"], "horizon = -1.0: must be a finite number > 0"),
    ],
)
def test_bad_input_is_refused_in_one_line(capsys, arguments, words):
    assert assess(*arguments) == cli.REFUSED
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert words in err
