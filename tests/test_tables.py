"""Parameters and results are stated in one table each; everything else follows from it.

A copy of the sources is given one more parameter, force and result, as docs/ describes; the copy is
run by a process of its own.
"""

import ast
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from model.engine.results import RESULTS
from model.physics.parameters import PARAMETER_NAMES

PROJECT = Path(__file__).resolve().parents[1]
SOURCES = PROJECT / "src" / "model"

# file under src/model, text there, what is inserted behind it
EDITS = [
    (
        "physics/parameters.py",
        '    press_force: float = entry("f0", "initial pressing force", FORCE)\n',
        '    side_pull: float = entry("f_x", "constant lateral force", FORCE, default=0.0)\n',
    ),
    (
        "physics/forces.py",
        "from model.physics.trigonometry import sine_cosine\n",
        "\n\n@inlined_kernel\ndef side_pull(p):\n    return p.side_pull\n",
    ),
    ("physics/forces.py", "        lateral_suspension(q, p)", " + side_pull(p)"),
    (
        "engine/results.py",
        "class Results(Value, Generic[OutcomeT, ReasonT, Real, Count, Flag]):\n",
        '    first_height: Real = entry("height of the centre at the start", LENGTH)\n',
    ),
    (
        "engine/start.py",
        "    q, mode = start(p, scene.declared)\n",
        "    runs[i, AT.first_height] = q.y\n",
    ),
]


@pytest.fixture(scope="module")
def trees() -> dict[str, ast.Module]:
    """Every file of the package, parsed."""
    return {
        path.relative_to(SOURCES).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted(SOURCES.rglob("*.py"))
    }


def collected(tree: ast.AST) -> Iterator[tuple[int, set[str]]]:
    """Lines of literal collections, calls and classes, with the names that each states."""
    for node in ast.walk(tree):
        named: list[Any] = []
        if isinstance(node, ast.Tuple | ast.List | ast.Set):
            named = [each.value for each in node.elts if isinstance(each, ast.Constant)]
        elif isinstance(node, ast.Dict):
            named = [each.value for each in node.keys if isinstance(each, ast.Constant)]
        elif isinstance(node, ast.Call):
            named = [each.arg for each in node.keywords]
        elif isinstance(node, ast.ClassDef):
            named = [each.target.id for each in node.body if isinstance(each, ast.AnnAssign)]
        if named:
            yield node.lineno, {each for each in named if isinstance(each, str)}


@pytest.mark.parametrize(
    ("table", "stated_in"),
    [(PARAMETER_NAMES, "physics/parameters.py"), (tuple(RESULTS), "engine/results.py")],
)
def test_no_other_place_in_the_package_lists_half_of_the_table(trees, table, stated_in):
    places = {
        path
        for path, tree in trees.items()
        for _, names in collected(tree)
        if len(names & set(table)) > len(table) / 2
    }
    # Those that an engineer adjusts or measures are chosen for the leeways, and are over a half.
    assert places - {"device/leeways.py"} == {stated_in}


def test_constants_and_results_are_never_made_by_position(trees):
    by_position = [
        f"{path}:{node.lineno}"
        for path, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in ("Constants", "RunResult")
        and not all(isinstance(each, ast.Starred) for each in node.args)
    ]
    assert by_position == []


def extended(folder: Path) -> Path:
    """A copy of the sources with one more parameter, force and result."""
    source = Path(shutil.copytree(PROJECT / "src", folder / "src"))
    shutil.copytree(PROJECT / "config", folder / "config")
    for file, there, inserted in EDITS:
        path = source / "model" / file
        text = path.read_text(encoding="utf-8")
        assert text.count(there) == 1, (file, there)
        path.write_text(text.replace(there, there + inserted), encoding="utf-8")
    return source


def told(source: Path, script: str, **environment: str) -> Any:
    """JSON that ``script`` prints, with ``source`` in place of the package."""
    run = subprocess.run(
        [sys.executable, "-c", script],
        cwd=PROJECT,
        env={**os.environ, "PYTHONPATH": str(source), **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


VIEWS = """
import contextlib, io, json, pathlib

import vibralign.commands.simulate
from vibralign import Batch, simulate
from vibralign.commands import main as cli
from model.physics.notation import State
from model.physics.parameters import Constants
from model.physics.variants import Variants
from vibralign.device.paper import baseline
from model.sweeps.io import VARIABLES, parameter_attributes
from vibralign.device import load_device

def printed(*arguments):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert cli.main(["simulate", *arguments]) == cli.DONE
    return out.getvalue()

# The unvibrated control takes long as Python.
vibralign.commands.simulate.unvibrated_words = lambda *_: ""
vibralign.commands.simulate.unvibrated_record = lambda *_: {}
base = baseline()
pulled = base.replace(side_pull=0.5)
peg = load_device(pathlib.Path("docs/peg.yaml"), {"side_pull": 2.0})
rows = Batch.of(base, side_pull=[0.0, 0.5]).constants(Variants())
short = "--horizon", "1e-3", "--set", "side_pull=0.5"
place = Constants._fields.index("side_pull")
runs = [simulate(each, horizon=1e-3) for each in (base, pulled)]
print(json.dumps({
    "default": base.side_pull,
    "constants": rows[:, place].tolist(),
    "si": [peg.units.force, peg.parameters.side_pull],
    "help": [line.split() for line in printed("--help").splitlines() if "side_pull" in line],
    "dataset": parameter_attributes("side_pull"),
    "x": [run.state[-1][0] for run in runs],
    "result": [runs[0].first_height, runs[0].state[0][1]],
    "variable": VARIABLES["first_height"],
    "line": [line.split()[-1] for line in printed(*short).splitlines()
             if line.startswith("height of the centre at the start")],
    "json": json.loads(printed(*short, "--json"))["first_height"],
}))
"""

SERIES = """
from model.engine.mode_kinds import ALIGNMENT_KINDS
from model.engine.series import recurrences
from model.physics.parameters import Constants

place = Constants._fields.index("side_pull")
constant = recurrences(ALIGNMENT_KINDS[0]).accelerations[0].constant
print(str(repr(("given", place)) in repr(constant)).lower())
"""


def test_one_more_parameter_and_result_reach_every_view(tmp_path):
    source, cache = extended(tmp_path), str(tmp_path / "kernels")
    assert told(source, SERIES, VIBRALIGN_CACHE=cache), "the series hold it"
    found = told(source, VIEWS, VIBRALIGN_CACHE=cache, VIBRALIGN_NO_COMPILATION="1")
    assert found["default"] == 0.0
    assert found["constants"] == [0.0, 0.5]
    force, scaled = found["si"]
    assert scaled == pytest.approx(2.0 / force)
    assert found["help"] == [["side_pull", "f_x", "0", "N", "constant", "lateral", "force"]]
    assert found["dataset"] == {
        "long_name": "constant lateral force",
        "symbol": "f_x",
        "units": "1",
    }
    assert found["x"][0] != found["x"][1]
    height, at_start = found["result"]
    assert height == at_start == found["json"]
    assert found["variable"] == {"units": "1", "long_name": "height of the centre at the start"}
    assert found["line"] == [f"{height:.9g}"]


PULLED = """
import json
from vibralign import SUSPENDED, Settings, align, simulate
from vibralign.device.paper import baseline

base = baseline().replace(side_pull=0.05)
raised = base.replace(press_force=-3.0, frequency=0.0, lateral_damping=2.0)
hanging = simulate(raised, Settings(scene=SUSPENDED, horizon=200.0, may_settle=False))
runs = [align([base]), simulate(base)]
print(json.dumps({
    "moved": hanging.state[-1][0] - base.misalignment,
    "expected": 0.05 / base.lateral_stiffness,
    "height": [runs[0].first_height[0], runs[1].first_height],
}))
"""


@pytest.mark.nightly
def test_one_more_force_and_result_are_computed(tmp_path):
    found = told(extended(tmp_path), PULLED, VIBRALIGN_CACHE=str(tmp_path / "kernels"))
    assert found["moved"] == pytest.approx(found["expected"], rel=1e-6)  # f = k_x (x - x_st)
    assert found["height"][0] == found["height"][1]
