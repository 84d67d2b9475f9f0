"""``vibralign``: what it prints, what it refuses, and how it ends."""

import json
import math
import os
import re
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pytest
import yaml

from model.engine.results import RESULTS, TRACK_VARIABLES
from model.events.outcomes import OUTCOME_TEXT, Outcome, Reason, remedy
from model.physics.parameters import PARAMETER_NAMES
from model.physics.variants import Variants
from model.runs.simulate import simulate
from study.config import load_study, study_path
from vibralign.commands import main as cli
from vibralign.commands import simulate as simulate_command
from vibralign.device import load_device
from vibralign.device.paper import baseline

ALIGNING = ["simulate", "--set", "press_force=2", "--set", "tilt_stiffness=10"]
OWN = yaml.safe_load((Path(__file__).parents[2] / "device.yaml").read_text(encoding="utf-8"))
OWN = {**OWN["structure"], **OWN["operating_point"], "press_force": 9.0, "tilt_stiffness": 2.0}
SETS = [part for each in OWN.items() for part in ("--set", "{}={}".format(*each))]
OVERTURNING = ["simulate", *SETS]


@pytest.fixture(scope="module")
def settings():
    return load_study(study_path()).settings.settings


@pytest.fixture(scope="module")
def aligning(settings):
    return simulate(baseline().replace(press_force=2.0, tilt_stiffness=10.0), settings)


def printed(text: str) -> dict[str, str]:
    """The lines of the report, by their first words."""
    lines = [re.split(r" {2,}", line.strip(), maxsplit=1) for line in text.splitlines()]
    return {line[0]: line[1] for line in lines if len(line) == 2}


# --- What a run prints --------------------------------------------------------------------------


def test_an_aligned_run_prints_its_moment_error_state_and_cost(capsys, aligning):
    assert cli.main(ALIGNING) == cli.DONE
    lines = printed(capsys.readouterr().out)
    assert lines["outcome"] == f"aligned: {OUTCOME_TEXT[Outcome.ALIGNED]}"
    value, error = (float(each) for each in lines["alignment time"].split(" ± "))
    assert value == pytest.approx(aligning.tau_align, abs=error)
    for name in ("tau_corners_inside", "tilt_at_alignment", "rhs_evaluations", "separations"):
        shown = float(lines[RESULTS[name].meaning])
        assert shown == pytest.approx(getattr(aligning, name), rel=1e-8)
    names = ("x", "y", "tilt", "x_rate", "y_rate", "tilt_rate")
    state = [float(lines[TRACK_VARIABLES[name].meaning]) for name in names]
    assert state == pytest.approx(aligning.state[-1], rel=1e-8)
    share = float(lines[RESULTS["sticking_share"].meaning].split()[0])
    assert share == pytest.approx(100 * aligning.sticking_share, rel=0.01)


def test_json_holds_all_of_it(capsys, aligning, settings):
    assert cli.main([*ALIGNING, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["outcome"] == "aligned"
    assert record["tau_align"] == aligning.tau_align
    assert record["tau_error"] == aligning.tau_error
    assert list(record["final_state"].values()) == aligning.state[-1].tolist()
    assert record["parameters"] == asdict(aligning.parameters)
    assert record["readings"] == asdict(settings.readings)
    assert record["horizon"] == settings.horizon
    assert record["tolerance"] == settings.tolerance
    assert record["rhs_evaluations"] == aligning.rhs_evaluations
    assert record["sensitive"] is False


def test_a_run_that_does_not_align_says_why_and_what_to_do(capsys):
    def no_constants(text):
        raise AssertionError(f"{text} is not JSON")

    assert cli.main(OVERTURNING) == cli.DONE
    lines = printed(capsys.readouterr().out)
    assert lines["outcome"].startswith("left_scene: ")
    assert "90 degrees" in lines["outcome"]
    assert lines["what to do"] == remedy(Outcome.LEFT_SCENE, Reason.OVERTURNED)
    assert lines["alignment time"] == "none: it does not align"
    assert cli.main([*OVERTURNING, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out, parse_constant=no_constants)
    assert record["tau_align"] is record["tau_error"] is None
    assert record["reason"] == "overturned"
    assert record["remedy"] == remedy(Outcome.LEFT_SCENE, Reason.OVERTURNED)


def short(capsys, *arguments: str) -> dict:
    """The record of a short run."""
    assert cli.main(["simulate", "--horizon", "0.1", "--json", *arguments]) == cli.DONE
    return json.loads(capsys.readouterr().out)


def test_the_study_and_the_command_line_start_from_the_same(capsys, settings):
    record = short(capsys)
    assert record["parameters"] == asdict(baseline())
    assert record["readings"] == asdict(settings.readings) == asdict(Variants())


@pytest.mark.parametrize("name", PARAMETER_NAMES)
def test_every_parameter_can_be_set_by_its_name(capsys, name):
    value = {"misalignment": 0.3, "rest_x": 0.25, "rest_y": 4.0, "approach_speed": 2.0}.get(name)
    value = 1.01 * getattr(baseline(), name) + 0.001 if value is None else value
    start = ["--start", "running"] if name == "approach_speed" else []
    record = short(capsys, "--set", f"{name}={value!r}", *start)
    assert record["parameters"] == asdict(baseline().replace(**{name: value}))


def test_a_spring_can_be_relaxed_where_the_part_starts(capsys):
    assert short(capsys, "--set", "rest_x=None")["parameters"]["rest_x"] is None


def test_horizon_and_tolerance_are_used(capsys):
    record = short(capsys, "--horizon", "0.5", "--tolerance", "1e-7")
    assert record["outcome"] == "horizon_reached"
    assert (record["horizon"], record["tolerance"]) == (0.5, 1e-7)
    assert record["final_time"] == pytest.approx(0.5)


def test_a_switch_overrides_the_preset(capsys):
    given = ["--reading", "all=printed", "--reading", "preload=consistent"]
    readings = short(capsys, *given)["readings"]
    assert readings.pop("preload") == "consistent"
    assert set(readings.values()) == {"printed"}


def test_a_failed_run_has_its_own_exit_code_and_a_sensitive_one_says_so(
    capsys, monkeypatch, aligning
):
    def end(**changed) -> tuple[int, str]:
        run = type(aligning)(**{**vars(aligning), **changed})
        monkeypatch.setattr(simulate_command, "simulate", lambda *_: run)
        return cli.main(["simulate"]), capsys.readouterr().out

    code, said = end(outcome=Outcome.FAILED, tau_align=math.nan)
    assert code == cli.FAILED
    assert printed(said)["outcome"].startswith("failed: ")
    assert printed(said)["what to do"] == remedy(Outcome.FAILED, aligning.reason)
    code, said = end(sensitive=True)
    assert "note: sensitive" in said


# --- What is refused, beside the lines of test_bad_input.py -------------------------------------


def test_a_picture_in_a_folder_that_cannot_be_written(capsys, tmp_path, monkeypatch):
    # Not by chmod: root, whom containers run as, may write everywhere.
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert cli.main(["simulate", "--plot", str(tmp_path / "run.png")]) == cli.REFUSED
    assert "permission denied" in capsys.readouterr().err


def test_an_interruption_ends_without_a_traceback(capsys, monkeypatch):
    def interrupted(*_arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(simulate_command, "simulate", interrupted)
    assert cli.main(["simulate"]) == cli.INTERRUPTED
    assert capsys.readouterr().err == "vibralign: interrupted\n"


# --- Pictures, help, version --------------------------------------------------------------------


@pytest.mark.parametrize(("suffix", "head"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_plot_writes_a_picture(capsys, tmp_path, suffix, head):
    path = tmp_path / f"run.{suffix}"
    assert cli.main([*ALIGNING, "--plot", str(path)]) == cli.DONE
    assert path.read_bytes().startswith(head)
    assert capsys.readouterr().err == ""


def test_as_a_command():
    # Plotting, statistics and datasets are slow to import, and need not be installed for this.
    code = (
        "import runpy, sys\n"
        "sys.modules['scipy'] = None\n"
        "try: runpy.run_module('vibralign.commands.main', run_name='__main__', alter_sys=True)\n"
        "finally: assert not {'matplotlib', 'xarray', 'jinja2'} & set(sys.modules)"
    )
    command = [sys.executable, "-c", code, *ALIGNING]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert re.match("outcome +aligned", done.stdout)


# --- A device in SI units -----------------------------------------------------------------------

PEG = str(study_path().parents[1] / "tests" / "square" / "peg.yaml")


def test_a_device_file_gives_results_in_si_units(capsys):
    assert cli.main(["simulate", "--device", PEG, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    run, second = simulate(load_device(PEG).parameters), math.sqrt(0.3 / 3000.0)
    assert record["units"] == "SI"
    assert record["tau_align"] == pytest.approx(run.tau_align * second)
    assert record["final_time"] == pytest.approx(float(run.time[-1]) * second)
    assert record["final_state"]["y"] == pytest.approx(run.state[-1][1] * 1e-3)
    assert record["contact_force_max"] == pytest.approx(run.contact_force_max * 3.0)
    assert record["horizon"] == pytest.approx(300.0 * second)
    assert record["parameters"]["press_force"] == 10.0
    assert cli.main(["simulate", "--device", PEG]) == cli.DONE
    said = capsys.readouterr().out
    time = re.search(r"alignment time +(\S+) ms\n", said)
    assert float(time[1]) == pytest.approx(1e3 * record["tau_align"], rel=1e-3)
    assert re.search(r"largest normal force at one place, from this start +19.99 N\n", said)
    words = "edge 19.99 N, corner 0 N, side 0 N, wall 0 N, until alignment"
    assert re.search(rf"  of the force +{words}\n", said)
    assert re.search(r"scene +alignment: .*; --scene insertion goes .*, as assess does\n", said)
    # A part with chamfers is not followed so far, and one that is says no more: neither says how.
    for more in (["--set", "peg_chamfer=0.1 mm"], ["--scene", "insertion"]):
        assert cli.main(["simulate", "--device", PEG, *more]) == cli.DONE
        assert not re.search(r"^scene", capsys.readouterr().out, re.MULTILINE)
    assert re.search(r"touch-down +one start, at phase 0 rad .*; vibralign assess takes all", said)
    assert re.search(r"  velocity along y +\S+ mm/s\n", said)
    assert record["natural_frequencies"]["axial"] == pytest.approx(50.0 / math.pi)
    assert record["excitation_ratios"]["axial"] == pytest.approx(math.pi)  # 50 Hz
    assert "axial 15.92 Hz, lateral 2.055 Hz, tilt 16.78 Hz; excitation at 3.14, " in said
    assert "dimensionless" not in said


def test_with_a_device_what_is_set_is_in_si_units(capsys):
    changes = ["--set", "press_force=0.04 kN", "--horizon", "10 ms"]
    assert cli.main(["simulate", "--device", PEG, *changes, "--json"]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["parameters"]["press_force"] == pytest.approx(40.0)
    assert (record["outcome"], record["final_time"]) == ("horizon_reached", pytest.approx(0.01))
    assert record["tau_align"] is None


@pytest.mark.parametrize("unit", [" mm", "e-3"])
def test_the_depth_at_which_a_device_is_inserted_is_in_si_units(capsys, unit):
    given = ["--device", PEG, "--scene", "insertion", "--insertion-depth", f"0.5{unit}", "--json"]
    assert cli.main(["simulate", *given]) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["outcome"] == "inserted"
    state = record["final_state"]
    low = 20e-3 * math.cos(state["tilt"]) - state["y"] - 5e-3 * math.sin(abs(state["tilt"]))
    assert low == pytest.approx(0.5e-3, rel=1e-6)
    assert record["insertion_depth"] == pytest.approx(0.5e-3)


def test_a_doubtful_device_runs_with_a_warning(capsys):
    given = ["--device", PEG, "--set", "amplitude=6 mm", "--horizon", "1 ms"]
    assert cli.main(["simulate", *given]) == cli.DONE
    err = capsys.readouterr().err
    assert err.startswith("vibralign: warning: ")
    assert "amplitude = 6 mm is larger than half_width = 5 mm" in err


def test_the_start_is_that_of_the_option_or_of_the_file(capsys):
    def start_of(*arguments):
        record = short(capsys, *arguments)
        assert record["unvibrated"] in ("aligns", "rests", "leaves")
        return record["start"]

    assert start_of() == "simultaneous"
    assert start_of("--start", "pressed") == "pressed"
    assert start_of("--device", PEG) == "simultaneous"  # approach_speed: sudden
    still = "--set", "vibrator=still", "--set", "approach_speed=20 mm/s"
    assert start_of("--device", PEG, *still) == "still"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["--start", "pressed"], ["pressed", "vibrator: still"]),
        (["--start", "simultaneous"], ["simultaneous", "approach_speed: sudden"]),
        (["--set", "vibrator=on"], ["'on'", "running, still"]),
        (["--set", "approach_speed=sudden", "--set", "vibrator=still"], ["still", "no effect"]),
        (["--set", "approach_speed=fast"], ["'fast'", "m/s"]),
        (["--set", "approach_speed=-1 mm/s"], ["must be a finite number > 0"]),
        (["--set", "phase=0 ± 1"], ["phase", "no effect"]),
        (["--set", "gripper_tilt=0 deg ± 5 %"], ["gripper_tilt", "no effect", "amount"]),
        (["--set", "misalignment=-1 mm"], ["misalignment = -0.001", ">= 0"]),
        (["--set", "misalignment=40 mm"], ["wholly beside"]),
        (["--set", "peg_chamfer=5 mm"], ["peg_chamfer = 0.005", "half_width"]),
        (["--set", "hole_chamfer=2 mm"], ["the chamfers meet", "no vibration needed"]),
        (["--set", "misalignment=0.21 mm", "--set", "gripper_tilt=-5 deg"], ["already inside"]),
        (["--set", "peg_chamfer=0.1 mm", "--scene", "insertion"], ["chamfer", "no further"]),
    ],
)
def test_a_start_that_makes_no_sense_is_answered_with_what_to_write(given, words, capsys):
    assert cli.main(["simulate", "--device", PEG, *given]) == cli.REFUSED
    said = capsys.readouterr().err
    assert all(each in said for each in words), said


@pytest.mark.parametrize(
    "closed",
    ["<&- >&- 2>&-"]
    + [
        pytest.param(each, marks=pytest.mark.nightly) for each in (">&-", "<&-", "2>&-", ">&- 2>&-")
    ],
)
def test_standard_streams_may_be_closed(tmp_path, closed):
    picture = tmp_path / "run.svg"
    command = f"{sys.executable} -m vibralign simulate --horizon 1 --plot {picture} {closed}"
    run = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert run.returncode == cli.DONE
    assert "Traceback" not in run.stderr
    assert picture.read_text(encoding="utf-8").startswith("<?xml")  # and nothing else came into it


@pytest.mark.parametrize(
    "backend",
    ["module://matplotlib_inline.backend_inline", pytest.param("no", marks=pytest.mark.nightly)],
)
def test_the_backend_of_a_notebook_does_not_matter(tmp_path, backend):
    picture = tmp_path / "run.png"
    words = [sys.executable, *["-m", "vibralign", "simulate", "--horizon", "1", "--plot"]]
    own = {**os.environ, "MPLBACKEND": backend}
    run = subprocess.run([*words, picture], env=own, capture_output=True, check=False)
    assert run.returncode == cli.DONE, run.stderr
    assert picture.is_file()
