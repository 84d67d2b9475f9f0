"""``vibralign assess``: output, its units, and refusals."""

import json
import re
from pathlib import Path

import pytest

from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings
from vibralign.answers import leeways
from vibralign.answers.cases import cases_of
from vibralign.answers.reliability import run_devices
from vibralign.answers.yields import drawn
from vibralign.commands import main as cli
from vibralign.device import load_device

PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")
COARSE = ["--horizon", "60", "--tolerance", "1e-6"]
IN_SECONDS = ["--horizon", "200 ms", "--tolerance", "1e-6"]  # of the peg: 20 of its units


BASE = ["--set", "contact_stiffness=300 kN/m"]  # as the model takes it where it is left open


def said(capsys, *arguments: str, code: int = cli.DONE) -> str:
    """Run the command, and return what it prints."""
    assert cli.main(["assess", *arguments]) == code
    return capsys.readouterr().out


def test_a_device_in_si_units_is_assessed_in_si_units(capsys, monkeypatch):
    monkeypatch.setattr(leeways, "VARIED", ("press_force",))
    monkeypatch.setattr(leeways, "UNITS", ())
    lines = said(capsys, "--device", PEG, *IN_SECONDS, *BASE).splitlines()
    assert lines[0] == f"device          {PEG}, with contact_stiffness=300 kN/m"
    words = "verdict         reliable at the stated values; no tolerances are stated"
    assert lines[1] == words
    assert lines[2].split() == ["starts", "goes", "in", "from", "48", "of", "48", "starts"]
    assert re.fullmatch(r"alignment time  [\d.]+ to [\d.]+ ms, by the start", lines[3])
    assert re.fullmatch(r"inserted after  [\d.]+ to [\d.]+ ms", lines[4])
    assert re.match(r"lift-offs       0 to 1; touches down at up to [\d.]+ mm/s", lines[5])
    assert re.fullmatch(r"at most +contact force [\d.]+ N, tilt .*, over all starts", lines[6])
    places = r"edge [\d.]+ N, corner [\d.]+ N, side [\d.]+ N, wall [\d.]+ N, until inserted"
    assert re.fullmatch(rf"  of the force  {places}", lines[7])
    force = next(line for line in lines if line.startswith("  press_force"))
    assert force.endswith("its value 10 N")


def test_a_failing_start_is_named_with_a_remedy(capsys):
    lines = said(
        capsys, *COARSE, "--set", "tilt_stiffness=2", "--set", "press_force=8"
    ).splitlines()
    assert lines[0] == "device          the paper's, dimensionless (no --device)"
    assert lines[1].startswith("verdict         not reliable at the stated values; ")
    assert lines[2] == "starts          goes in from 0 of 32 starts"
    example = next(i for i, line in enumerate(lines) if line.startswith("for example"))
    assert lines[example] == "for example     phase = 0, initial_tilt = 0.001"
    assert lines[example + 1].startswith(
        "cause           it topples or jumps off: the tilt reached"
    )
    assert lines[example + 2].startswith("first to change ")


@pytest.mark.usefixtures("_no_leeways")
def test_the_yield_of_a_device_that_goes_in_from_no_start_is_said_by_few_devices(capsys):
    device = str(Path(PEG).parent / "devices" / "peg.yaml")
    line = ["--device", device, *IN_SECONDS, "--horizon", "20 ms", "--set", "tilt_stiffness=30"]
    lines = said(capsys, *line).splitlines()
    share = "yield 0 % (0 % to 1.478 %, 95 % confidence)"
    words = f"not reliable at the stated values; {share} under the tolerances"
    assert lines[1] == f"verdict         {words}"
    assert lines[2] == "starts          goes in from 0 of 48 starts"
    end = lines.index("assumed:")
    assert lines[end + 8].startswith("  tolerances  as stated: ")
    lines = lines[:end]
    shown = lines[next(i for i, line in enumerate(lines) if line.startswith("yield")) :]
    share = share.replace("yield", "yield          ")
    assert shown[0].startswith(f"{share}: 0 of 256 devices")
    names = [line.strip().split("  ")[0] for line in shown[1:]]
    assert names == ["contact force", "at most", "fails nearest"]
    assert shown[-1].endswith("the device itself is not reliable")


@pytest.mark.usefixtures("_no_leeways")
def test_a_yield_is_required_with_confidence(capsys, tmp_path):
    path = tmp_path / "peg.yaml"
    text = Path(PEG).read_text(encoding="utf-8").replace("friction: 0.15", "friction: 0.15 ± 0.02")
    path.write_text(text + "contact_stiffness: 300 kN/m\n", encoding="utf-8")
    line = ["--device", str(path), *IN_SECONDS, "--devices", "8", "--require"]
    met = said(capsys, *line, "0.5")
    words = "yield           100 % (67.56 % to 100 %, 95 % confidence): 8 of 8 devices"
    assert words in met  # 8 / (8 + 1.96²)
    assert "required        50 %: met" in met
    assert "required        90 %: not met" in said(capsys, *line, "0.9", code=cli.FAILED)


def with_limits(tmp_path, limits: str) -> str:
    """The peg with a tolerance and limits, in a file of its own."""
    text = Path(PEG).read_text(encoding="utf-8").replace("friction: 0.15", "friction: 0.15 ± 0.02")
    path = tmp_path / "peg.yaml"
    text += f"contact_stiffness: 300 kN/m\nlimits: {{{limits}}}\n"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.usefixtures("_no_leeways")
def test_a_limit_of_the_file_is_kept_or_exceeded(capsys, tmp_path):
    path = with_limits(tmp_path, "contact_force: 90 N, time: 5 ms, vibration: not needed")
    line = ["--device", path, *IN_SECONDS, "--devices", "8"]
    shown = said(capsys, *line, "--require", "0.5", code=cli.FAILED)
    value = r"[\d.]+ m?s"
    words = rf"reliable at the stated values, but exceeds the limit of time \({value} > 5 ms\)"
    words += r" and of vibration \(needed against not needed\)"
    assert re.search(rf"^verdict +{words}; yield 100 %", shown, re.MULTILINE)
    row = r"  contact_force  limit 90 N +[\d.]+ N as stated +[\d.]+ N of all drawn +kept\n"
    row += rf"  time           limit 5 ms +{value} as stated +{value} of all drawn +exceeded\n"
    row += r"  vibration      limit not needed +needed as stated +needed of all drawn +exceeded\n"
    assert re.search(rf"^limits:\n{row}", shown, re.MULTILINE)
    assert "required        50 %: not met, as a limit is exceeded\n" in shown
    record = json.loads(said(capsys, *line, "--json"))
    force, time, _ = record["limits"]
    assert [each["kept"] for each in record["limits"]] == [True, False, False]
    assert time["itself"] == record["tau_worst"]
    assert force["itself"] == record["contact_force_max"]
    runs = drawn_devices(path)
    assert (force["drawn"], time["drawn"]) == (runs.force.max(), runs.time.max())
    assert record["yield"]["largest"]["tilt"] == runs.tilt.max()
    most = f"at most {1e3 * runs.time.max():.4g} ms of all drawn"
    assert re.search(rf"^alignment time .* \(5, 50, 95 %\); {most}$", shown, re.MULTILINE)
    most = f"at most {runs.force.max():.2g} N of all drawn"
    assert re.search(rf"^contact force .* \(5, 50, 95 %\); {most}$", shown, re.MULTILINE)


@pytest.mark.usefixtures("_no_leeways")
def test_a_limit_that_only_drawn_devices_exceed_is_said_so(capsys, tmp_path):
    line = [*IN_SECONDS, "--devices", "8", "--require", "0.5", "--device"]
    record = json.loads(said(capsys, *line, with_limits(tmp_path, "time: 1 s"), "--json"))
    [time] = record["limits"]
    assert time["itself"] < time["drawn"]
    between = 0.5 * (time["itself"] + time["drawn"])
    path = with_limits(tmp_path, f"time: {between!r}")
    verdict = said(capsys, *line, path, code=cli.FAILED).splitlines()[1]
    words = "confidence) under the tolerances, but within them it exceeds the limit of time ("
    assert verdict.startswith("verdict         reliable at the stated values; yield 100 %")
    assert words in verdict


def drawn_devices(path: str):
    stated = load_device(path)
    settings = Settings(scene=INSERTION, tolerance=1e-6, horizon=0.2 / stated.units.time)
    cases = cases_of(stated, Ensemble())
    return run_devices(stated, drawn(stated, 8), cases, settings)
