"""``vibralign map``: output, and refusals before anything is computed."""

import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome
from model.runs.settings import Settings
from model.sweeps import sweep
from vibralign import Batch, align, load_device, simulate
from vibralign.commands import main as cli
from vibralign.commands.map import _safest
from vibralign.device.paper import baseline

PLANE = ["--x", "tilt_stiffness", "6", "20", "--y", "press_force", "1", "5"]
SMALL = ["--resolution", "5", "--horizon", "30", "--tolerance", "1e-7"]


def run(folder, *arguments: str) -> int:
    return cli.main(["map", *PLANE, *SMALL, "--out", str(folder / "map.nc"), *arguments])


def test_a_map_is_written_and_drawn_for_any_device(tmp_path, capsys):
    picture = tmp_path / "map.png"
    assert run(tmp_path, "--plot", str(picture), "--set", "friction=0.05") == cli.DONE
    out, err = capsys.readouterr()
    assert err == ""  # no progress where nobody looks
    lines, _, assumed = out.partition("assumed:\n")
    words = "where it goes in, from the stated start, until inserted"
    assert re.search(rf"largest force +[\d.]+ to [\d.]+ {words}\n", lines)
    # Half of the press force, at most the half-width, from 1 to 5.
    assert "varies over the map: inserted to a depth of 0.5 (half of 1, " in assumed
    assert "(the half-width, of 5, " in assumed
    assert {line.split()[0] for line in assumed.splitlines()} == {
        "shape", "start", "touch-down", "goal", "base", "horizon", "precision",
    }  # fmt: skip
    assert {line.split()[0] for line in lines.splitlines()} == {
        "goes", "reliable", "safest", "vibration", "sensitive", "largest",
    }  # fmt: skip
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        assert {"tau_align", "unvibrated", "start_outcome", "reliable", "margin"} <= set(stored)
        assert stored["friction"] == 0.05
        assert stored["inertia"] == baseline().inertia
        assert stored["tilt_stiffness"].values.tolist() == [6.0, 9.5, 13.0, 16.5, 20.0]
        assert stored.attrs["horizon"] == 30.0
        assert stored["start_outcome"].shape == (5, 5, 2, 16)  # a coarse map: at every node
        assert np.isin(stored["outcome"], list(Outcome)).all()
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_dimensionless_map_of_a_round_part_is_round(tmp_path):
    given = ["--shape", "round", "--set", "misalignment=0.6", "--resolution", "3"]
    assert run(tmp_path, *given) == cli.DONE
    with xr.open_dataset(tmp_path / "map.nc") as stored:
        force, stiffness = (stored[name].values for name in ("press_force", "tilt_stiffness"))
        axes = np.meshgrid(force, stiffness, indexing="ij")
        own = baseline().replace(misalignment=0.6)
        values = {"press_force": axes[0].ravel(), "tilt_stiffness": axes[1].ravel()}
        found, outcomes = {}, stored["outcome"].values.ravel()
        for shape in ("round", "square"):
            settings = Settings(shape=shape, scene=INSERTION, horizon=30.0, tolerance=1e-7)
            found[shape] = align(Batch.of(own, **values), settings)
        assert (outcomes == found["round"].outcome).all()
        assert not (outcomes == found["square"].outcome).all()
        same = stored["contact_force_max"].values.ravel() == found["round"].contact_force_max
        assert same.all()


PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")
SI_PLANE = ["--device", PEG, "--x", "tilt_stiffness", "0.4", "0.8", "--y", "frequency", "10", "60"]


def test_a_device_in_si_units_gets_a_map_in_si_units(tmp_path):
    picture = tmp_path / "map.svg"
    assert run(tmp_path, *SI_PLANE, "--plot", str(picture)) == cli.DONE
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
        expected = simulate(device, Settings(horizon=30.0, tolerance=1e-7)).tau_align * units.time
        np.testing.assert_allclose(stored["tau_align"].values[node], expected, rtol=1e-5)
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
    # The mass is the square of the time unit, √(M/K_Y) with 20 kN/m.
    units = f"{0.3 / math.sqrt(0.5 / 2e4):.4g} to {0.3 / math.sqrt(0.7 / 2e4):.4g}"
    words = "until alignment, and as long again until insertion, at the corners of the map"
    assert f"  horizon     300 ms ({units} units of 1/p) {words}\n" in said
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


def test_the_safest_node_lies_within_the_reliable_area_and_the_limits():
    """An area of 5 by 7 nodes, whose middle is its third row and fourth column."""
    force, amplitude = np.arange(9) + 4.0, (np.arange(9) + 1.0) * 1e-4
    reliable = np.zeros((9, 9), np.int8)
    reliable[2:7, 1:8] = 1
    axes = {"start_press_force": force, "start_amplitude": amplitude}
    dataset = xr.Dataset({"reliable": ([*axes], reliable)}, axes)
    stated = load_device(PEG)
    assert _safest(dataset, None).startswith("--set press_force=8 --set amplitude=0.0004, ")
    assert _safest(dataset, stated).startswith("--set 'press_force=8 N' --set 'amplitude=0.4 mm'")
    limited = replace(stated, limits={"stroke": 0.61e-3})  # columns 1 and 2 are left
    assert "amplitude=0.2 mm" in _safest(dataset, limited)
    strict = replace(stated, limits={"acceleration": 9.0})  # 0.09 mm at 50 Hz
    assert _safest(dataset, strict) == "none within the limits of the vibrator"


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
