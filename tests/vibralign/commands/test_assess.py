"""``vibralign assess``: output, its units, and refusals."""

import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from model.physics.quantities import FORCE, TIME
from model.sweeps.settings import Ensemble
from vibralign import INSERTION, Settings
from vibralign.answers import assess, leeways
from vibralign.answers.assess import Assessment
from vibralign.answers.cases import cases_of
from vibralign.answers.leeways import Leeway
from vibralign.answers.reliability import run_devices
from vibralign.answers.sheet import sheet_rows
from vibralign.answers.si import si_list
from vibralign.answers.verdicts import Base, Verdict
from vibralign.answers.yields import drawn
from vibralign.commands import main as cli
from vibralign.commands.yields import yield_words
from vibralign.device import load_device
from vibralign.device.approach import Approach
from vibralign.device.base import restitution_at
from vibralign.device.stated import FOLLOWED

PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")
NAN = float("nan")
IN_SECONDS = ["--horizon", "200 ms", "--tolerance", "1e-6"]  # of the peg: 20 of its units


BASE = ["--set", "contact_stiffness=300 kN/m"]  # as the model takes it where it is left open


def said(capsys, *arguments: str, code: int = cli.DONE) -> str:
    """Run the command, and return what it prints with all details."""
    assert cli.main(["assess", "--details", *arguments]) == code
    return capsys.readouterr().out


def row(said: str, label: str) -> str:
    """Return the words of a row of the sheet."""
    return next(line[16:] for line in said.splitlines() if line.startswith(f"{label:<16}"))


def test_a_device_in_si_units_is_assessed_in_si_units(capsys, monkeypatch):
    monkeypatch.setattr(leeways, "VARIED", ("press_force",))
    monkeypatch.setattr(leeways, "UNITS", ())
    shown = said(capsys, "--device", PEG, *IN_SECONDS, *BASE)
    part = "square, 10 mm by 40 mm, play 0.4 mm, 0.8 mm beside the hole"
    assert row(shown, "device") == f"{PEG}, with contact_stiffness=300 kN/m: {part}"
    assert row(shown, "verdict") == "reliable at the stated values; no tolerances are stated"
    assert row(shown, "goes in") == (
        "from all 48 touch-downs tried: 3 tilts of the gripper; followed to a depth of 1.67 mm"
    )
    times = r"[\d.]+ to [\d.]+ ms until aligned, [\d.]+ to [\d.]+ ms until inserted; from the touch"
    assert re.fullmatch(times, row(shown, "time"))
    assert re.match(r"[\d.]+ N at the \w+, ", row(shown, "largest force"))
    assert row(shown, "vibration").startswith("needed: only pressed, it ")
    open_ones = "gripper_tilt: tried as above; state gripper_tilt first: this "
    assert row(shown, "not stated").endswith(f"; {open_ones}changes the force most")
    assert row(shown, "lift-offs") == "0 to 1"
    force = next(line for line in shown.splitlines() if line.startswith("  press_force"))
    assert force.endswith("its value 10 N")


def test_a_failing_start_is_named_with_a_remedy(capsys):
    stiff = ["--set", "tilt_stiffness=30", "--set", "gripper_tilt=0 deg"]
    shown = said(capsys, "--device", PEG, *IN_SECONDS, *BASE, *stiff)
    assert row(shown, "verdict").startswith("not reliable at the stated values; ")
    assert row(shown, "goes in").startswith("from 0 of 16 touch-downs tried")
    assert row(shown, "for example") == "phase = 0 deg"
    assert row(shown, "cause").startswith("too slow: at the horizon it has come ")
    assert row(shown, "first to change")
    assert row(shown, "reliable with")


@pytest.mark.usefixtures("_no_leeways")
def test_the_yield_of_a_device_that_goes_in_from_no_start_is_said_by_few_devices(capsys):
    device = str(Path(PEG).parent / "devices" / "peg.yaml")
    line = ["--device", device, *IN_SECONDS, "--horizon", "20 ms", "--set", "tilt_stiffness=30"]
    shown = said(capsys, *line)
    share = "0 % (0 % to 5.7 %, 95 % confidence)"
    words = f"not reliable at the stated values; yield {share} under the tolerances"
    assert row(shown, "verdict") == words
    assert row(shown, "goes in").startswith("from 0 of 48 touch-downs tried")
    assert row(shown, "yield").startswith(f"{share}: 0 of 64 devices")
    assert not {"fails nearest", "to blame", "alignment time"} & {
        each[:16].strip() for each in shown.splitlines()
    }
    assert "  tolerances  as stated: " in shown


@pytest.mark.parametrize(
    ("good", "count", "said"),
    [(0, 256, "0 % (0 % to 1.5 %"), (2, 256, "0.8 % (0.2 % to 2.8 %"),
     (4096, 4096, "100 % (99.906 % to 100 %"), (3155, 4096, "77 % (75.7 % to 78.3 %")],
)  # fmt: skip
def test_a_share_has_the_digits_that_its_interval_leaves(good, count, said):
    assert yield_words(SimpleNamespace(going_in=good, devices=count)).startswith(said)


def test_two_values_far_apart_are_in_their_own_units():
    assert si_list([32.7, 1600.0], FORCE, " to ", 3) == "32.7 N to 1.6 kN"
    assert si_list([12.9, 477.0], FORCE, " to ", 3) == "12.9 to 477 N"
    assert si_list([0.5, 1.6], TIME, " to ", 3) == "0.5 to 1.6 s"


def test_the_impact_that_is_taken_is_said_not_to_be_stated():
    own = {"contact_stiffness": 3e5, "approach_speed": "sudden", "gripper_tilt": 0.0}
    found = Assessment(load_device(PEG), 1, 1, 2.0, 3.0, None)
    stated = load_device(PEG, own | {"restitution": 0.4})
    assert dict(sheet_rows(replace(found, device=stated)))["not stated"].startswith("nothing")
    assert restitution_at(stated.parameters, "square") == pytest.approx(0.4)
    bare = load_device(PEG, own)
    taken = restitution_at(bare.parameters, "square")
    taken = f"restitution: the model's damping gives {taken:.2g}"
    assert dict(sheet_rows(replace(found, device=bare)))["not stated"].startswith(taken)
    shown = dict(sheet_rows(replace(found, device=replace(bare, stated_shape=None))))["device"]
    assert ": round (not stated), 10 mm by " in shown
    fixed = load_device(PEG, {"approach_speed": "sudden", "fixture_stiffness": 3e5})
    rows = dict(sheet_rows(replace(found, device=fixed)))
    assert rows["not stated"].startswith("the base on its fixture, gripper_tilt: ")


def test_a_part_with_chamfers_is_said_to_be_followed_up_to_these():
    stated = load_device(PEG, {"peg_chamfer": "0.1 mm", "contact_stiffness": 3e5})
    rows = dict(sheet_rows(Assessment(stated, 1, 1, 2.0, 3.0, None)))
    words = "reliable at the stated values, up to where the chamfers meet"
    assert rows["verdict"] == words
    assert rows["aligns"].endswith(f"; {FOLLOWED}")


def test_a_sheet_is_short_and_its_words_are_those_of_the_tutorial(capsys, monkeypatch):
    leeway = Leeway("friction", 0.15, 0.01, 0.2, fails_above=0.21)
    base = Verdict(Base(1e3, 0.3), 16, 16, 2.0, 3.0, 1.0, 1.5)
    found = Assessment(
        load_device(PEG),
        32,
        32,
        2.0,
        3.0,
        None,
        leeways=(leeway,),
        bases=(base, base),
        unvibrated="rests on the edge",
    )
    monkeypatch.setattr(assess, "assess", lambda device, *_, **__: replace(found, device=device))
    [own] = json.loads(said(capsys, "--device", PEG, "--json"))["leeways"]
    assert own["as_stated"] == {
        "value": "0.15",
        "low": "0.01",
        "high": "0.2",
        "fails_above": "0.21",
    }
    assert cli.main(["assess", "--device", PEG]) == cli.DONE
    sheet = capsys.readouterr().out
    assert len(sheet.splitlines()) <= 14
    assert not re.search(r"\bnan\b|- - -|\de[+-]\d\d|-0\.0\b", sheet.replace(" 1e-10 ", ""))
    assert row(sheet, "fails from") == "friction 0.21 (stated 0.15)"
    assert row(sheet, "vibration") == "needed: only pressed, it rests on the edge"
    assert row(sheet, "more").startswith("--details ")
    found = replace(found, leeways=(replace(leeway, fails_above=0.15004),))
    assert cli.main(["assess", "--device", PEG]) == cli.DONE
    assert row(capsys.readouterr().out, "fails from") == "friction 0.15004 (stated 0.15)"
    fast, slow = (
        Verdict(Approach("running", speed), 16, 16, 2.0, tau)
        for speed, tau in ((0.1, 2.5), (0.01, 3.0))
    )
    words = dict(sheet_rows(replace(found, device=load_device(PEG), approaches=(fast, slow))))
    said_of = "; all this with the approach that is slowest, running, 10 mm/s"
    assert words["fails from"] == f"friction 0.15004 (stated 0.15){said_of}"


@pytest.mark.usefixtures("_no_leeways")
def test_a_yield_is_required_with_confidence(capsys, tmp_path):
    path = tmp_path / "peg.yaml"
    text = Path(PEG).read_text(encoding="utf-8").replace("friction: 0.15", "friction: 0.15 ± 0.02")
    path.write_text(text + "contact_stiffness: 300 kN/m\n", encoding="utf-8")
    line = ["--device", str(path), *IN_SECONDS, "--devices", "8", "--require"]
    met = said(capsys, *line, "0.5")
    words = "yield           100 % (68 % to 100 %, 95 % confidence): 8 of 8 devices"
    assert words in met  # 8 / (8 + 1.96²)
    assert "required        50 %: met" in met
    missed = row(said(capsys, *line, "0.9", code=cli.FAILED), "required")
    assert missed == "90 %: not met, as the yield is too low"


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
    words += r" and of vibration \(needed although the file says not needed\)"
    assert re.search(rf"^verdict +{words}; yield 100 %", shown, re.MULTILINE)
    limits = rf"contact_force [\d.]+ N of 90 N, time {value} > 5 ms: exceeded, vibration needed "
    assert re.match(limits + "although the file says not needed: exceeded", row(shown, "limits"))
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
    assert "devices within the tolerances:\n" in shown
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
    words = "confidence) under the tolerances; some of the devices drawn exceed the limit of time ("
    assert verdict.startswith("verdict         reliable at the stated values; yield 100 %")
    assert words in verdict


@pytest.mark.usefixtures("_no_leeways")
def test_a_limit_that_no_tolerance_alters_stands_beside_one_that_some_alter(capsys, tmp_path):
    path = with_limits(tmp_path, "time: 1 s, stroke: 9 mm")
    shown = said(capsys, *IN_SECONDS, "--devices", "8", "--device", path)
    assert re.match(r"all kept: time [\d.]+ m?s of 1 s, stroke 2 mm of 9 mm", row(shown, "limits"))


@pytest.mark.usefixtures("_no_leeways")
def test_a_limit_of_the_vibrator_counts_the_devices_drawn(capsys, tmp_path):
    path = with_limits(tmp_path, "acceleration: 15 g, stroke: 2 mm")  # 10.06 g at 50 Hz
    line = ["--device", path, *IN_SECONDS, "--devices", "8", "--set", "frequency=50 Hz ± 25 %"]
    shown = said(capsys, *line)
    words = r"some of the devices drawn exceed the limit of acceleration \(1[56][\d.]* g > 15 g\)\n"
    assert re.search(rf"^verdict +reliable .*; {words}", shown, re.MULTILINE)
    limits = r"acceleration 1[56][\d.]* g > 15 g: exceeded, stroke 2 mm of 2 mm$"
    assert re.match(limits, row(shown, "limits"))


def drawn_devices(path: str):
    stated = load_device(path)
    settings = Settings(scene=INSERTION, tolerance=1e-6, horizon=0.2 / stated.units.time)
    cases = cases_of(stated, Ensemble())
    return run_devices(stated, drawn(stated, 8), cases, settings)
