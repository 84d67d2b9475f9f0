"""``vibralign map``: output, and refusals before anything is computed."""

import math
import re
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome
from model.runs.settings import Settings
from model.sweeps import sweep
from vibralign import load_device, simulate
from vibralign.commands import main as cli

PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")
PLANE = ["--device", PEG, "--x", "tilt_stiffness", "0.4", "0.8", "--y", "press_force", "4", "20"]
SMALL = ["--resolution", "5", "--horizon", "0.3", "--tolerance", "1e-7"]


def run(folder, *arguments: str) -> int:
    return cli.main(["map", *PLANE, *SMALL, "--out", str(folder / "map.nc"), *arguments])


def test_a_map_is_written_and_drawn_for_any_device(tmp_path, capsys):
    picture = tmp_path / "map.png"
    assert run(tmp_path, "--plot", str(picture), "--set", "friction=0.05") == cli.DONE
    out, err = capsys.readouterr()
    assert err == ""  # no progress where nobody looks
    lines, _, assumed = out.partition("assumed:\n")
    words = "N where it goes in, from the stated start, until inserted"
    assert re.search(rf"largest force +[\d.]+ to [\d.]+ {words}\n", lines)
    # Half of what the press reaches against the axial spring of 3 kN/m.
    assert "varies over the map: inserted to a depth of 0.6667 mm (half of 1.333 mm, " in assumed
    assert "; inserted to a depth of 3.333 mm (half of 6.667 mm, " in assumed
    assert {line.split()[0] for line in assumed.splitlines()} == {
        "shape", "start", "touch-down", "goal", "base", "horizon", "precision", "tolerances",
        "changed",
    }  # fmt: skip
    assert {line.split()[0] for line in lines.splitlines()} == {
        "goes", "reliable", "vibration", "sensitive", "largest",
    }  # fmt: skip
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        assert {"tau_align", "unvibrated", "start_outcome", "reliable", "margin"} <= set(stored)
        assert stored["friction"] == 0.05
        assert stored["inertia"] == 450e-7
        np.testing.assert_allclose(stored["tilt_stiffness"], [0.4, 0.5, 0.6, 0.7, 0.8])
        assert stored["start_outcome"].shape == (5, 5, 3, 16)  # a coarse map: at every node
        assert np.isin(stored["outcome"], list(Outcome)).all()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_device_in_si_units_gets_a_map_in_si_units(tmp_path):
    picture = tmp_path / "map.svg"
    plane = ["--y", "frequency", "10", "60", "--plot", str(picture)]
    assert run(tmp_path, *plane) == cli.DONE
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        np.testing.assert_allclose(stored["tilt_stiffness"], [0.4, 0.5, 0.6, 0.7, 0.8])
        np.testing.assert_allclose(stored["frequency"], [10.0, 22.5, 35.0, 47.5, 60.0])
        assert stored["frequency"].attrs["units"] == "Hz"
        assert stored["tau_align"].attrs["units"] == "s"
        assert (float(stored["mass"]), stored["mass"].attrs["units"]) == (0.3, "kg")
        np.testing.assert_allclose(stored["half_width"], 0.005)
        inserted = stored["outcome"].values == Outcome.INSERTED
        assert inserted.any()
        node = tuple(np.argwhere(inserted)[0])
        at = {
            name: float(stored[name][i])
            for name, i in zip(stored["outcome"].dims, node, strict=True)
        }
        units, device = load_device(Path(PEG), at).device
        one = simulate(device, Settings(horizon=0.3 / units.time, tolerance=1e-7))
        seconds = one.tau_align * units.time
        np.testing.assert_allclose(stored["tau_align"].values[node], seconds, rtol=1e-5)
    assert "tilt_stiffness (N m/rad)" in picture.read_text()


def test_a_map_of_a_device_is_over_any_of_its_quantities_with_units(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    shaft = str(Path(PEG).parent / "devices" / "shaft.yaml")
    plane = ["--x", "misalignment", "300um", "0.5 mm", "--y", "mass", "500g", "700g"]
    arguments = ["--device", shaft, *plane, "--resolution", "3", "--horizon", "300 ms"]
    out = tmp_path / "map.nc"
    assert cli.main(["map", *arguments, "--tolerance", "1e-7", "--out", str(out)]) == cli.DONE
    said, progress = capsys.readouterr()
    assert "\rnodes and starts\033[K" in progress
    for mass in (0.5, 0.7):  # the square of the time unit, √(M/K_Y) with 20 kN/m
        assert f"300 ms ({0.3 / math.sqrt(mass / 2e4):.4g} units of 1/p) until alignment" in said
    assert "goal        inserted to a depth of 0.3 mm (half" in said
    with xr.open_dataset(out) as stored:
        np.testing.assert_allclose(stored["misalignment"], [3e-4, 4e-4, 5e-4])
        np.testing.assert_allclose(stored["mass"], [0.5, 0.6, 0.7])
        assert (stored["mass"].attrs["units"], float(stored["amplitude"])) == ("kg", 3e-4)
        assert "contact_damping" not in stored  # follows the mass, by the restitution
        for row, mass in enumerate((0.5, 0.6, 0.7)):
            stated = load_device(Path(shaft), {"mass": mass, "misalignment": 3e-4})
            horizon = 0.3 / stated.units.time  # in seconds for every mass
            run = simulate(stated, Settings(horizon=horizon, tolerance=1e-7, scene=INSERTION))
            assert stored["outcome"].values[row, 0] == run.outcome
            seconds = run.tau_align * stated.units.time
            np.testing.assert_allclose(stored["tau_align"].values[row, 0], seconds, rtol=1e-4)


def test_an_interrupted_map_leaves_the_old_file(tmp_path, capsys, monkeypatch):
    old = tmp_path / "map.nc"
    old.write_text("old")

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(sweep, "run_once", interrupted)
    assert run(tmp_path) == cli.INTERRUPTED
    assert "interrupted" in capsys.readouterr().err
    assert old.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["map.nc"]


def test_an_axis_may_begin_below_zero(tmp_path, capsys):
    out = tmp_path / "map.nc"
    few = ["--resolution", "2", "--horizon", "1 ms", "--out", str(out)]
    for given in (["-5deg", "5deg"], ["-5..5 deg"], ["-5..5", "deg"], ["−5deg", "5deg"]):
        plane = ["--x", "gripper_tilt", *given, "--y", "amplitude", "1 mm p-p", "2 mm p-p"]
        assert cli.main(["map", "--device", PEG, *plane, *few]) == cli.DONE
        with xr.open_dataset(out) as stored:
            np.testing.assert_allclose(stored["gripper_tilt"], np.radians([-5.0, 5.0]))
            np.testing.assert_allclose(stored["amplitude"], [5e-4, 1e-3])
    capsys.readouterr()
    assert cli.main(["simulate", "--horizon", "-1e-3"]) == cli.REFUSED
    assert "horizon = -0.001: must be a finite number > 0" in capsys.readouterr().err


def test_axes_that_reach_where_no_device_is_are_doubted(capsys, tmp_path):
    axes = ["--x", "friction", "0.1", "0.2", "--y", "amplitude", "0.1", "1"]  # in metres
    few = ["--resolution", "2", "--horizon", "1 ms", "--out", str(tmp_path / "map.nc")]
    assert cli.main(["map", "--device", PEG, *axes, *few]) == cli.DONE
    told = capsys.readouterr().err
    assert "at friction = 0.1, amplitude = 0.1 m: amplitude = 100 mm is larger than" in told
