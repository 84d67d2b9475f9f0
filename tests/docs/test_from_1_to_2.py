"""What "From 1 to 2" lists of release 1 is answered by what to write instead."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from study import __main__ as study
from vibralign.commands import main as cli

ROOT = Path(__file__).parents[2]
PEG = ROOT / "docs" / "peg.yaml"
TABLES = ("Device files", "Commands", "Python")

# Rows whose old spelling is still right: what it means, or what is answered, has changed.
KEPT = {
    "`misalignment`, at the mass centre", "no approach", "no shape: square", "no base: one base",
    "a tolerance that reaches where no device can be: cut off",
    "`assess` prints some sixty lines", "`--scene alignment` of a part with chamfers",
    "`design --devices` 4096", "`design` continued from `--out`, at other frictions",
    "records of starts", "warnings on the command line only", "the extra `study`",
}  # fmt: skip
# By row: lines of a device file, after which `simulate` is refused, and what to write instead.
LINES = {
    "`initial_tilt`, `rest_tilt`": dict.fromkeys(
        ("initial_tilt: 0.01", "rest_tilt: 1 deg"), "write gripper_tilt"
    ),
    "`rest_x`, `rest_y`": {"rest_x: 0.1 mm": "leave it out", "rest_y: 0": "state press_force"},
    "`start: simultaneous`": {"start: simultaneous": "write approach_speed: sudden"},
    "`start: pressed`": {"start: pressed": "write vibrator: still, and approach_speed: 3 mm/s"},
    "`half_height` beside `centre_height`": {"centre_height: 20 mm": "leave one out"},
    "± on a limit, a horizon or a depth: ignored": {"limits: {time: 1 s ± 5 %}": "no tolerance"},
    "`15,000 mN`, `phase: 25 %`, `gr`, `grad`: read somehow": {
        "press_force: 15,000 mN": "write a decimal point", "phase: 25 %": "% is no unit of it",
        "mass: 300 gr": "write 300 g or 300 grain",
        "tilt_stiffness: 1 Nm/grad": "write 1 Nm/deg or 1 Nm/gon",
    },
}  # fmt: skip
_OF_STUDY = ("runs", "show", "diff", "verify", "accept", "claims")
_FILTERS = ("parameter", "since", "until", "current")
COMMANDS = {
    "`runs`, `show`, `diff`, `verify`, `accept`, `claims` of `vibralign`": {
        f"vibralign {each}": f"it is `python -m study {each}`" for each in _OF_STUDY
    },
    "`export` (MLflow)": dict.fromkeys(
        ("vibralign export", "study export"), "`python -m study runs --json` has its numbers"
    ),
    "`runs --invocations`": {"study runs --invocations": "is --starts now"},
    "`runs --parameter`, `--since`, `--until`, `--current`": {
        f"study runs --{each}": "filter what --json prints" for each in _FILTERS
    },
    "`--dimensionless`": {
        f"vibralign {each} --device {PEG} --dimensionless": "in Python returns dimensionless"
        for each in ("assess", "simulate")
    },
    "`assess`, `map`, `explore` without `--device`": {
        f"vibralign {each}": "--device"
        for each in (
            "assess",
            "explore --out a.html",
            "map --x mass 1 2 --y friction 0 1 --out a.nc",
        )
    },
    "`--readings printed`": {"vibralign simulate --readings printed": "--reading all=printed"},
    "`design --out`, `--plot`": {
        f"vibralign design --device {PEG} --out a.nc": "returns every setting",
        f"vibralign design --device {PEG} --plot a.png": "assess --sheet and vibralign map",
    },
    "`new --from`": {f"vibralign new a.yaml --from {PEG}": "copy the file"},
    "`simulate --animate`": {"vibralign simulate --animate run.html": "explore animates the run"},
    "`assess --bases`": {
        f"vibralign assess --device {PEG} --bases": "leave the base out of the device file"
    },
    "`--start` with `--device`": {
        f"vibralign {each} --device {PEG} --start pressed": "write vibrator: still"
        for each in ("simulate", "assess")
    },
}
CALLS = {
    "`from model import …`": {
        "from model import simulate": "write `from vibralign import simulate`",
        "import model; model.align": "write `from vibralign import align`",
    },
    "`model.study.config.baseline`": {
        "from model.study.config import baseline": "from vibralign import baseline"
    },
    "`model.study.assessment.yields.yield_of`, `Yield`, `DeviceResults`": {
        "from model.study.assessment.yields import Yield": "yield_of, Yield, DeviceResults"
    },
    "`read_device(path)`": {
        "from vibralign import read_device": "from vibralign import load_device",
        "import vibralign; vibralign.read_device": "write load_device",
    },
    "`align(…, engine=…)`": {
        f"import vibralign; vibralign.{each}('{PEG}', engine='batch')": "leave it out"
        for each in ("align", "simulate")
    },
    "`reliable_at` of `Parameters`": {
        "import vibralign; vibralign.reliable_at(vibralign.baseline())": "only simulate and align"
    },
    "`StatedDevice.start`": {
        f"import vibralign; vibralign.load_device('{PEG}').start": "write `vibrator` and `sudden`",
        **{
            f"from vibralign import *; {each}('{PEG}', start='pressed')": "vibrator: still"
            for each in ("simulate", "align", "sweep")
        },
        **{
            f"from vibralign import *; {each}('{PEG}', Settings(start='pressed'))": "write vibrator"
            for each in ("assess", "reliable_at")
        },
    },
}


def old_in(heading: str) -> list[str]:
    """Return the first cells of the table under a heading."""
    text = (ROOT / "docs" / "from-1-to-2.md").read_text(encoding="utf-8")
    section = text.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return re.findall(r"^\| (.*?) \| ", section, re.MULTILINE)[1:]


def of(rows: dict[str, dict[str, str]]) -> list[tuple[str, str]]:
    return [each for answers in rows.values() for each in answers.items()]


def test_every_row_is_asked():
    listed = [row for heading in TABLES for row in old_in(heading)]
    assert sorted(listed) == sorted({*KEPT, *LINES, *COMMANDS, *CALLS})


@pytest.mark.parametrize(("line", "words"), of(LINES), ids=lambda each: each)
def test_an_old_line(line, words, tmp_path, capsys):
    name = line.partition(":")[0]
    lines = PEG.read_text(encoding="utf-8").splitlines()
    kept = [each for each in lines if not each.startswith(f"{name}:")]
    (tmp_path / "peg.yaml").write_text("\n".join([*kept, line, ""]), encoding="utf-8")
    assert cli.main(["simulate", "--device", str(tmp_path / "peg.yaml")]) == cli.REFUSED
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(("given", "words"), of(COMMANDS), ids=lambda each: each[:60])
def test_an_old_command(given, words, capsys):
    program, *arguments = given.split()
    main = {"vibralign": cli.main, "study": study.main}[program]
    assert main(arguments) == cli.REFUSED
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(("code", "words"), of(CALLS), ids=lambda each: each[:60])
def test_an_old_call(code, words):
    with pytest.raises((ImportError, AttributeError, TypeError, ValueError)) as refusal:
        exec(code, {})  # noqa: S102 - the calls above
    assert words in str(refusal.value)


def test_who_asks_if_a_name_is_there_is_told_no():
    code = (
        "import model, vibralign; print(hasattr(model, 'align'), hasattr(vibralign, 'read_device'))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout == "False False\n"
