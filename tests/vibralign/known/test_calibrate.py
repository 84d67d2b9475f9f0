"""``vibralign calibrate``: from a table to a device file that other commands read; refusals."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from tests.vibralign.known.bench import FILE
from vibralign import known_in_part, load_device
from vibralign.commands import main as cli
from vibralign.commands.calibrate import next_lines, report
from vibralign.known import posterior
from vibralign.known.calibrate import Calibration
from vibralign.known.fit import Fit
from vibralign.known.next_trial import Next, Worth
from vibralign.known.possible import sets_of

TABLE = """press_force [N];amplitude [mm];result [ms]
10;2;80
14;2;46,5
4;1,2;190
"""
TORN = "press_force,result\n" + "10 N,20 ms\n" * 3 + "10 N,fails after 2 s\n" * 3


def command(folder, table: str, *more: str) -> list[str]:
    trials = folder / "trials.csv"
    trials.write_text(table)
    return ["calibrate", "--device", str(FILE), "--trials", str(trials), *more]


def test_trials_become_a_device_file_that_commands_read(tmp_path, capsys):
    out = tmp_path / "fit.yaml"
    assert cli.main(command(tmp_path, TABLE, "--out", str(out), "--json")) == cli.DONE
    record = json.loads(capsys.readouterr().out)
    assert record["fits"]
    assert record["effective_sample_size"] >= 100.0
    low, middle, high = record["unknowns"]["friction"]
    assert 0.05 <= low < middle < high <= 0.4
    assert record["next"]["trials"][0]["bits"] >= record["next"]["trials"][-1]["bits"] >= 0.0
    assert len(record["next"]["bench"]) == 2
    device = load_device(out)
    assert device.samples == tmp_path / "fit.nc"
    sets = sets_of(device, 4096)
    assert low < np.median(sets["friction"]) < high
    with xr.open_dataset(tmp_path / "fit.nc") as stored:
        assert stored["weight"].sum() == pytest.approx(1.0)
        assert stored["friction"].attrs["units"] == "1"
        assert stored.attrs["Conventions"].startswith("CF")
        correlation = np.corrcoef(sets["friction"], sets["tilt_stiffness"])[0, 1]
        table = np.cov(stored["friction"], stored["tilt_stiffness"], aweights=stored["weight"])
        assert correlation == pytest.approx(
            table[0, 1] / np.sqrt(table.diagonal().prod()), abs=0.03
        )
    found = known_in_part(out, sets=256, touch_downs_tried=1)
    weights = xr.load_dataset(tmp_path / "fit.nc")["weight"].values
    assert found.effective == pytest.approx(1.0 / (weights**2).sum(), rel=0.2)
    assert known_in_part(FILE, sets=16, touch_downs_tried=4).effective == 16.0
    (tmp_path / "fit.nc").write_bytes(b"no netCDF")
    assert cli.main(["assess", "--device", str(out)]) == cli.REFUSED
    assert "vibralign calibrate again" in capsys.readouterr().err


def test_of_trials_that_do_not_fit_nothing_is_known(tmp_path, capsys):
    out = tmp_path / "fit.yaml"
    assert cli.main(command(tmp_path, TORN, "--out", str(out))) == cli.FAILED
    text = capsys.readouterr().out
    assert text.startswith("fit             THE MODEL DOES NOT FIT THESE TRIALS")
    assert "row 2" in text
    assert "nothing can be concluded" in text
    assert "posterior" not in text
    assert not out.exists()
    assert not (tmp_path / "fit.nc").exists()


REFUSED = [
    (TABLE, ["--out", "{0}/fit.txt"], "must end in one of .yaml, .yml"),
    (TABLE, ["--out", str(FILE)], "is the device file"),
    (TABLE, ["--out", "{0}/fit.yaml", "--set", "mass=0.4"], "--set mass"),
    (TABLE, ["--set", "friction=0.1", "--set", "tilt_stiffness=0.3"], "nothing is unknown"),
    (TABLE, ["--trials", "{0}/none.csv"], "none.csv: cannot be read"),
    ("preis,result\n", [], "'preis'"),
]


@pytest.mark.parametrize(("table", "more", "words"), REFUSED)
def test_bad_input_is_refused_before_anything_is_computed(tmp_path, capsys, table, more, words):
    more = [each.format(tmp_path) for each in more]
    assert cli.main(command(tmp_path, table, *more)) == cli.REFUSED
    out, err = capsys.readouterr()
    assert words in err
    assert (out, err.count("\n")) == ("", 1)


@pytest.mark.parametrize("bits", [0.012, 0.1])
def test_what_is_noise_is_not_proposed(bits):
    trials = Worth("10 N", bits, {}), Worth("12 N", 0.01, {})
    bench = Worth("measure friction", 0.26, {}), Worth("measure mass", 0.01, {})
    text = "\n".join(next_lines(Next({}, 0.5, math.nan, trials, bench), None))
    assert ("no trial would tell more than 0.02 bits" in text) == (bits < 0.02)
    assert ("10 N" in text) == ("worth 2.6 trials" in text) == (bits > 0.02)
    assert "measure friction  0.26 bits" in text
    assert not any(each in text for each in ("12 N", "mass"))
    none = next_lines(Next({}, 0.5, math.nan, trials[1:], bench[1:]), None)
    assert none[-1].startswith("next ")


@pytest.mark.parametrize(
    ("free", "words"), [({}, "for vibralign design"), ({"mass": (1.0, 2.0)}, "below free")]
)
def test_where_no_trial_helps_what_does_is_named(free, words):
    device = SimpleNamespace(device=SimpleNamespace(free=free))
    poor, good = (next_lines(Next({}, share, 0.0, (), ()), device)[-1] for share in (0.0, 1.0))
    assert poor.startswith("next            no trial is worth making: ")
    assert poor.endswith(words)
    assert good == "next            no trial is worth making"


def test_a_report_says_what_the_trials_support_and_when_the_sample_is_too_small():
    def likelihood(sets):
        return -0.5 * ((sets["friction"] - 0.2) / 0.002) ** 2

    found = posterior.sample(load_device(FILE).unknown, likelihood, target=1e6, most=96)
    for odds, words in (
        (-1.5, "neither contradict the model nor support it: trials made by the model are at"),
        (-1.5, "but chance, fitted to them, makes them 32 times as probable\n"),
        (2.0, "the model makes them 100 times as probable as chance does"),
        (6.2, "the model makes them 10^6 times"),
    ):
        fit = Fit(0.5, odds, ())
        text = "\n".join(report(Calibration(load_device(FILE), (), found, (), 1.0, fit)))
        assert words in text
        assert ("the model fits" in text) == (odds > 0.0)
        assert "too small to conclude; narrow the ranges" in text
    lines = report(Calibration(load_device(FILE), (), found, (), 1.0, Fit(0.01, -1.5, ())))
    assert "NOT FIT" in lines[0]
    assert lines[2].endswith("0; chance makes them 32 times as probable as the model does")
    assert found.weights.sum() == pytest.approx(1.0)
    for odds, first in ((0.4, "the model fits"), (0.5, "THE MODEL DOES NOT FIT")):
        fit = Fit(0.5, 2.0, (), {"a soft base": odds, "another": -1.0})
        lines = report(Calibration(load_device(FILE), (), found, (), 1.0, fit))
        assert lines[0].startswith(f"fit             {first}")
        (said,) = (each for each in lines if "a soft base makes the trials" in each)
        assert (said == lines[0]) == (odds > 0.45)
        assert ("from 3 times on, the model does not fit" in said) == (odds < 0.45)
