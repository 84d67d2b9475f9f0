"""Bad input to commands: one line that names the remedy, exit code 2, no files left behind."""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from model.physics.parameters import PARAMETER_NAMES
from model.physics.variants import VARIANT_NAMES
from model.sweeps.files import write_text
from study.config import study_path
from vibralign.commands import main as cli
from vibralign.plots import style

COMMAND = [sys.executable, "-m", "vibralign"]
PEG = str(study_path().parents[1] / "tests" / "square" / "peg.yaml")

OF_PEG = ["--device", PEG]
DEVICE = ["simulate", *OF_PEG]
DEPTH = ["--scene", "insertion", "--insertion-depth"]
TILT = ["--x", "tilt_stiffness"]
PLANE = [*TILT, "0.6", "2", "--y", "press_force", "1", "5"]
MAP = ["map", *OF_PEG, *PLANE, "--resolution", "4", "--out", "ROOT/map.nc"]
EXPLORE = ["explore", *OF_PEG, "--out"]

# The command line, and what the one line that refuses it must hold. ROOT is an empty folder.
LINES = [
    (["simulate", "--set", "half_width=0"], ["half_width", "> 0"]),
    (["simulate", "--set", "rest_x=anywhere"], ["rest_x", "'anywhere'", "None"]),
    (["simulate", "--tolerance", "1e-20"], ["tolerance", "1e-14"]),
    (["simulate", "--horizon", "-1"], ["horizon", "> 0"]),
    (["simulate", "--reading", "all=both"], ["'both'", "consistent", "printed"]),
    (["simulate", "--reading", "preload"], ["preload", "NAME=VALUE"]),
    (["simulate", "--plot", "ROOT/run.docx"], ["run.docx", ".png", ".svg"]),
    (["simulate", "--plot", "/dev/full/run.png"], ["/dev/full", "does not exist"]),
    (["simulate", "extra"], ["extra", "--help"]),
    (["simulate", "--set", "press_force"], ["press_force", "NAME=VALUE"]),
    (["simulate", "--plot", "ROOT/folder.png"], ["is a folder"]),
    (
        ["simulate", "--set", "pres_force=2"],
        ["unknown parameter 'pres_force'. Did you mean 'press_force'?", *PARAMETER_NAMES],
    ),
    (["simulate", "--set", "press_force=1e999"], ["press_force", "inf", "finite number"]),
    (["simulate", "--set", "misalignment=9"], ["misalignment", "9.0", "beside the slot"]),
    (["simulate", "--set", "friction=0.1", "--set", "friction=0.2"], ["friction", "twice"]),
    (["simulate", "--reading", "friction=printed"], ["'friction'", *VARIANT_NAMES]),
    (["simulate", "--insertion-depth", "0.2"], ["insertion_depth", "needs --scene insertion"]),
    ([*DEVICE, "--set", "half_width=-0.005"], ["half_width = -0.005: must be"]),
    (["simulate", "--device", "nowhere.yaml"], ["cannot be read"]),
    ([*DEVICE, "--set", "nu=1"], ["unknown quantity of a device 'nu'"]),
    ([*DEVICE, "--horizon", "3 mm"], ["must be in s or alike"]),
    ([*DEVICE, *DEPTH, "3 N"], ["must be in m or alike"]),
    ([*DEVICE, *DEPTH, "-1 mm"], ["insertion_depth = '-1 mm': must be a finite number > 0"]),
    ([], ["command"]),
    (["simulte"], ["simulte", "simulate"]),
    (["assess", "--device", PEG, "--set", "mass=0"], ["mass = 0.0: must be a finite number > 0"]),
    (["assess", *OF_PEG, "--devices", "100"], ["devices = 100: must be a power of two"]),
    (["assess", *OF_PEG, "--require", "0.9"], ["--require needs a device with tolerances"]),
    (["assess", *OF_PEG, "--require", "1.5"], ["require = 1.5: must be between 0 and 1"]),
    (["assess", *OF_PEG, "--sheet", "ROOT/sheet.png"], ["must end in .html"]),
    *(
        ([each], ["required: ", "--device"])
        for each in ("assess", "calibrate", "design", "explore")
    ),
    (["design", "--device", PEG], ["nothing is free"]),
    *(
        (["design", "--device", PEG, "--generations", n], [f"generations = {n}: must be a whole"])
        for n in ("0", "nan")
    ),
    ([*EXPLORE, "peg.txt"], ["must end in .html"]),
    ([*EXPLORE, "no/such/peg.html"], ["does not exist"]),
    ([*EXPLORE, "peg.html", "--reading", "all=printed"], ["consistent readings only"]),
    ([*EXPLORE, "peg.html", *DEPTH, "0.2 mm"], ["default depth only"]),
    ([*MAP, "--x", "mas", "1", "2"], ["Did you mean 'mass'?"]),
    ([*MAP, "--resolution", "1"], ["resolution = 1: must be a whole number, 2 to 1025"]),
    ([*MAP, *TILT, "5", "1"], ["--x tilt_stiffness 5 1: must be two finite numbers"]),
    ([*MAP, "--x", "press_force", "1", "2"], ["'press_force' is varied twice"]),
    ([*MAP, "--x", "friction", "-1", "2"], ["friction = -1.0: must be a finite number >= 0"]),
    ([*MAP, "--out", "map.csv"], ["--out map.csv: must end in .nc"]),
    ([*MAP, "--out", "nowhere/map.nc"], ["the folder nowhere does not exist"]),
]


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "file").write_text("no folder\n", encoding="utf-8")
    (folder / "folder.png").mkdir()
    return folder


@pytest.fixture
def _nothing_runs(monkeypatch):
    def forbidden(*_, **__):
        raise AssertionError("computed before everything was checked")

    monkeypatch.setattr("vibralign.commands.simulate.simulate", forbidden)
    for name in ("align", "run_once"):
        monkeypatch.setattr(f"model.sweeps.sweep.{name}", forbidden)


def is_refused(main, capsys, root, line, words):
    """The command ends before it computes, in one line, and leaves ``root`` as it was."""
    before = {path: path.is_file() and path.read_bytes() for path in root.rglob("*")}
    code = main([word.replace("ROOT", str(root)) for word in line])
    out, err = capsys.readouterr()
    assert code == cli.REFUSED
    assert out == ""
    assert err.startswith(("vibralign", "python -m study"))
    assert err.count("\n") == 1, err
    for word in words:
        assert word.replace("ROOT", str(root)) in err
    assert {path: path.is_file() and path.read_bytes() for path in root.rglob("*")} == before


@pytest.mark.usefixtures("_nothing_runs")
@pytest.mark.parametrize(("line", "words"), LINES, ids=[" ".join(line) for line, _ in LINES])
def test_a_command_line(capsys, monkeypatch, root, line, words):
    monkeypatch.chdir(root)
    is_refused(cli.main, capsys, root, line, words)


# ------------------------------------------------------------------------------------- environment


def run_with(line: list[str], **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **variables}
    return subprocess.run(
        [*COMMAND, *line], capture_output=True, text=True, check=False, env=environment
    )


@pytest.mark.parametrize("more", [[], ["--scene", "insertion", "--shape", "round"]])
def test_a_run_without_compiled_kernels(tmp_path, capsys, more):
    """Python computes what the compiled kernels do, to the rounding of fused operations."""
    line = ["simulate", "--horizon", "1", "--json", *more]
    assert cli.main(line) == cli.DONE
    compiled = json.loads(capsys.readouterr().out)
    done = run_with(line, VIBRALIGN_NO_COMPILATION="1", VIBRALIGN_CACHE=str(tmp_path))
    assert done.returncode == cli.DONE, done.stderr
    python = json.loads(done.stdout)
    assert compiled["outcome"] == python["outcome"]
    for name in ("tilt_max", "contact_force_max", "final_time"):
        assert compiled[name] == pytest.approx(python[name], rel=1e-9)


def test_a_dataset_whose_name_python_cannot_tell(tmp_path):
    folder = tmp_path / "ü"
    folder.mkdir()
    axes = ["--x", "friction", "0.1", "0.2", "--y", "press_force", "1", "2"]
    locale = {"LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
    done = run_with(["map", *OF_PEG, *axes, "--out", str(folder / "map.nc")], **locale)
    assert done.returncode == cli.REFUSED
    assert "Python takes the names of files for ASCII here: set PYTHONUTF8=1" in done.stderr


@pytest.mark.parametrize(("mask", "mode"), [(0o022, 0o644), (0o027, 0o640), (0o002, 0o664)])
def test_a_file_may_be_read_by_whom_the_umask_allows(tmp_path, mask, mode):
    before = os.umask(mask)
    try:
        write_text("text", tmp_path / "file")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == mode


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_picture_has_the_same_bytes_on_another_day(tmp_path, monkeypatch, kind):
    pictures = []
    for day in ("0", "1000000000"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", day)  # for matplotlib the present
        with style.context():
            figure = style.new_figure()
            figure.add_subplot().plot([0.0, 1.0], [1.0, 0.0], label="$\\phi$")
        style.write(figure, tmp_path / f"{day}.{kind}")
        pictures.append((tmp_path / f"{day}.{kind}").read_bytes())
    assert pictures[0] == pictures[1]


# --------------------------------------------------------------------------------------- full disk


def _small_files_only() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048))


@pytest.fixture
def compiled():
    """Kernels are on disk already: a command that cannot write must not have to compile."""
    assert cli.main(["simulate", "--horizon", "1"]) == cli.DONE


@pytest.mark.usefixtures("compiled")
def test_a_picture_on_a_full_disk(tmp_path):
    # A limit on the size of files stands for the full disk: the same call fails, half-way.
    picture = tmp_path / "run.png"
    done = subprocess.run(
        [*COMMAND, "simulate", "--horizon", "1", "--plot", str(picture)],
        capture_output=True, text=True, check=False, preexec_fn=_small_files_only,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    assert done.returncode == cli.FAILED
    assert done.stdout.startswith("outcome")  # the run is not lost
    assert done.stderr.count("\n") == 1
    assert str(picture) in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("compiled")
def test_printing_to_a_full_disk():
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(
            [*COMMAND, "simulate", "--horizon", "1"], stdout=full, stderr=subprocess.PIPE,
            text=True, check=False,
        )  # fmt: skip
    assert done.returncode == cli.FAILED
    assert "Traceback" not in done.stderr
    assert "space" in done.stderr
    assert done.stderr.count("\n") == 1
