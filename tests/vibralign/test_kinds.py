"""Kinds of mistakes that users of other tools met, each in the commands and in Python."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from vibralign import load_device, reliable_at, simulate, sweep
from vibralign.commands import main as cli
from vibralign.commands.files import check_file
from vibralign.device import DeviceError

ROOT = Path(__file__).resolve().parents[2]
PEG = ROOT / "docs" / "peg.yaml"


def peg(folder: Path, more: str) -> Path:
    (folder / "peg.yaml").write_text(PEG.read_text(encoding="utf-8") + more, encoding="utf-8")
    return folder / "peg.yaml"


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("limits: {time: 0.2 s ± 10 %}", "limits: time = '0.2 s ± 10 %': no tolerance here"),
        ("limits: {vibration: [needed]}", "must be needed or not needed"),
        ("limits: [time]", "must be lines of NAME: VALUE"),
        ("a: &a [*a]", "cannot be read as YAML"),
        ("fixture_stiffness: {a: 1}", "fixture_stiffness = {'a': '1'}: must be a number"),
        ("materials: [steel, steel]", "must be a text"),
        ("centre_height: 20 mm", "half_height and centre_height state the same: leave one out"),
        ("fixture_stiffness: 0.1 to 0.25 N/m", "state one value, or 0.175 ± 0.075 N/m"),
        ("chamfer: 1 mm", "unknown quantity of a device 'chamfer'. Did you mean"),
    ],
)
def test_a_structure_or_a_tolerance_where_a_value_is_expected_is_refused(tmp_path, more, words):
    with pytest.raises(DeviceError) as refusal:
        load_device(peg(tmp_path, f"{more}\n"))
    assert words in str(refusal.value)
    assert len(str(refusal.value)) < 400


@pytest.mark.parametrize(
    ("option", "given", "words"),
    [
        ("--horizon", "-1", "horizon = '-1': must be a finite number > 0"),
        ("--horizon", "1 s ± 0.1 s", "no tolerance here"),
        ("--insertion-depth", "5mm", "insertion_depth = '5mm': needs --scene insertion"),
        ("--insertion-depth", "5 mm ± 1 mm", "no tolerance here"),
    ],
)
def test_a_bad_value_is_named_as_it_was_given(capsys, option, given, words):
    assert cli.main(["simulate", "--device", str(PEG), option, given]) == cli.REFUSED
    assert words in capsys.readouterr().err
    if "±" in given:
        with pytest.raises(ValueError, match=words):
            simulate(PEG, scene="insertion", **{option[2:].replace("-", "_"): given})


def test_numbers_of_numpy_are_numbers_and_masked_ones_are_refused():
    for given in (np.int64(6), np.float32(6), [np.int64(6)], np.array(6)):
        found = sweep(PEG, press_force=given, horizon="1 ms").press_force
        assert np.ravel(found.values).tolist() == [6.0]
        assert (
            load_device(PEG, {"press_force": np.ravel(given)[0]}).quantities["press_force"] == 6.0
        )
    masked = np.ma.masked_array([5.0, 7.0], [0, 1])
    with pytest.raises(ValueError, match="masked"):
        sweep(PEG, press_force=masked)
    with pytest.raises(ValueError, match="press_force"):
        reliable_at(PEG, press_force=masked)
    with pytest.raises(ValueError, match="must be a number"):
        load_device(PEG, {"press_force": np.bool_(1)})


def test_a_path_that_is_no_regular_file_is_refused(tmp_path):
    (tmp_path / "loop.html").symlink_to(tmp_path / "loop.html")
    os.mkfifo(tmp_path / "pipe.html")
    (tmp_path / "null.html").symlink_to("/dev/null")
    for name, words in (
        ("loop", "is a link that leads nowhere"), ("pipe", "is no regular file"),
        ("null", "is no regular file"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=words):
            check_file(tmp_path / f"{name}.html", "--out", ["html"])
    assert not (tmp_path / "pipe.html").is_file()
    (tmp_path / "link.html").symlink_to(tmp_path / "new.html")
    check_file(tmp_path / "link.html", "--out", ["html"])


def test_without_a_home_folder_machine_code_goes_to_a_temporary_one(tmp_path):
    code = (
        "import pwd\n"
        "def none(_): raise KeyError\n"
        "pwd.getpwuid = none\n"
        "from model.compile.cache import cache_folder\n"
        "print(cache_folder())"
    )
    kept = {n: v for n, v in os.environ.items() if n not in ("HOME", "VIBRALIGN_CACHE")}
    environment = {**kept, "PYTHONPATH": str(ROOT / "src"), "TMPDIR": str(tmp_path)}
    environment.pop("XDG_CACHE_HOME", None)
    command = [sys.executable, "-c", code]
    said = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert Path(said.stdout.strip()).is_relative_to(tmp_path)


def test_a_tolerance_is_read_in_an_ascii_locale():
    locale = {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    given = ["simulate", "--device", str(PEG), "--set", "friction=0.15 ± 0.05", "--horizon", "1 ms"]
    command = [sys.executable, "-m", "vibralign", *given]
    environment = {**os.environ, **locale, "PYTHONPATH": str(ROOT / "src")}
    said = subprocess.run(command, env=environment, capture_output=True, check=False)
    assert said.returncode == cli.DONE, said.stderr
    assert b"horizon" in said.stdout


def test_a_device_file_without_its_option_is_told_the_option(capsys):
    assert cli.main(["simulate", str(PEG)]) == cli.REFUSED
    assert "a device file follows --device" in capsys.readouterr().err


def test_a_verdict_to_distrust_says_so_on_stdout(capsys):
    given = ["--device", str(PEG), "--set", "contact_stiffness=20 kN/m", "--horizon", "5 ms"]
    assert cli.main(["assess", *given]) == cli.DONE
    said = capsys.readouterr()
    assert "do not trust the verdict" in said.err
    verdict = next(line for line in said.out.splitlines() if line.startswith("verdict"))
    assert verdict.endswith("do not trust the verdict: the base is soft")
