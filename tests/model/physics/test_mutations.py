"""A unit test catches an error of 1 % in any one force, or at the tips of a round part.

The unit tests run on each mutation without being compiled.
"""

import json
import os
import subprocess
import sys

import pytest

from tests.model.mutations import PROJECT, replaced

UNIT_TESTS = [f"tests/model/physics/test_{name}.py" for name in ("motion", "contacts", "tips")]

# name: (file below src/model/physics, what stands before a force, the force that is changed)
MUTATIONS = {
    "lateral damping": ("forces.py", "-", "p.lateral_damping *"),
    "lateral stiffness": ("forces.py", "- ", "p.lateral_stiffness *"),
    "axial damping": ("forces.py", "-", "p.axial_damping *"),
    "axial stiffness": ("forces.py", "- ", "(q.y - p.rest_y)"),
    "tilt damping": ("forces.py", "-", "p.tilt_damping *"),
    "tilt stiffness": ("forces.py", "- ", "p.tilt_stiffness *"),
    "press force": ("forces.py", "return -", "p.press_force"),
    "excitation": ("forces.py", "return -", "sine\n"),
    "contact stiffness": ("contacts.py", "return ", "p.contact_stiffness * depth + p."),
    "contact damping": ("contacts.py", "depth + ", "p.contact_damping * closing_rate"),
    "force of the edge": ("motion.py", "_pressing(face, ", "contact_load("),
    "force of the corner": ("motion.py", "corner_load = ", "contact_load(corner.depth - mode"),
    "force on the side": ("motion.py", "_pressing(edge, ", "contact_load("),
    "friction": ("motion.py", "\n    friction = -", "p.friction"),
    "friction of the side": ("motion.py", "side_friction = -", "p.friction *"),
    "sticking friction": ("motion.py", "side_bottom = -", "drive, -side_drive, g11, g22"),
}

# Errors in the tips of round parts, in the same form; files below src/model.
GEOMETRY, CONTACTS = "physics/geometry.py", "physics/contacts.py"
EVENTS, SOURCES = "events/event_functions.py", "events/sources.py"
OF_TIPS = {
    "place of the tips": (GEOMETRY, "", "gap) / (reach + c"),
    "depth of the tips": (GEOMETRY, "p.half_height - height - ", "rim_x * s)"),
    "touch of the tips": (GEOMETRY, "square = ", "behind * behind"),
    "turn of the normal": (CONTACTS, "bent = ", "(a * a)"),
    "lever of the normal": (CONTACTS, "moment = ", "(along + bent) * x"),
    "compliance": (CONTACTS, "depth = ", "behind * reach"),
    "closing rate": (CONTACTS, "closing_rate = -dot(normal, ", "q.x_rate, q.y_rate, q.tilt_rate"),
    "wedge factor": (CONTACTS, "(square + ", "rise * rise)"),
    "lever of friction": (CONTACTS, "moment = rim_x - x, ", "(rim_x - x) * rise"),
    "drift along the face": (CONTACTS, "rise, -", "along * along_face / reach"),
    "drift by turning": (CONTACTS, "turning = ", "tilt_rate * (offset"),
    "drift by stretching": (CONTACTS, "stretching = ", "(offset * offset_rate"),
    "merging": (EVENTS, "return ", "p.half_width - mode.edge * at.along"),
    "lever of the press": (GEOMETRY, "return float(", "rim_x - p.misalignment"),
    "largest misalignment": (GEOMETRY, "math.hypot(", "flat"),
    "doubt of the lever": (GEOMETRY, "return ", "2.0 * p.half_width * force"),
}
# Name: (file, what stands there, what is wrong with it).
WRONG_TIPS = {
    "sign of the normal": (CONTACTS, "normal_y = -rise", "normal_y = rise"),
    "side of the normal": (CONTACTS, "normal = (side * normal_x", "normal = (normal_x"),
    "side of friction": (CONTACTS, "to_tangent, side * rise", "to_tangent, rise"),
    "no wedge factor": (CONTACTS, "(hole * hole) * (s", "(rim_x * rim_x) * (s"),
    "no tips": (CONTACTS, "tips_on_face(side, q, p) if", "edge_on_face(side, q, p) if"),
    "end by the tips' place": (SOURCES, "edge.along_face)\n", "face.along)\n"),
    "no side beside tips": (EVENTS, "depth + along - p", "along - p"),
    "beginning": (EVENTS, "return -depth, depth", "return depth, depth"),
}
EVERY = [*MUTATIONS, *OF_TIPS, *WRONG_TIPS]


# Collects the unit tests once; a fork for each mutation puts the wrong code in place of the right
# and runs them, those that are to catch it first.
RUN_EACH = """
import gc, importlib, json, os, sys
from inspect import unwrap
from types import FunctionType
import pytest

def put(module, code):
    wrong = dict(vars(module))
    exec(compile(code, module.__file__, "exec"), wrong)
    for name, function in vars(module).items():
        if isinstance(function, FunctionType) and function.__module__ == module.__name__:
            unwrap(function).__code__ = unwrap(wrong[name]).__code__

class Mutations:
    def pytest_collection_finish(self, session):
        gc.freeze()  # a fork need not look through what it shares
        for mutation, (module, code, at_tips) in mutations.items():
            if child := os.fork():
                codes[mutation] = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
                continue
            os.dup2(os.open(f"{logs}/{mutation}", os.O_WRONLY | os.O_CREAT), 1)
            put(importlib.import_module(module), code)
            session.items.sort(key=lambda item: (item.path.stem == "test_tips") != at_tips)
            return

logs, codes = sys.argv[1], {}
mutations, options = json.load(sys.stdin)
parent = os.getpid()
codes["none"] = pytest.main(options, [Mutations()])
if os.getpid() != parent:
    sys.stdout.flush()  # an exit without cleaning up loses what is buffered
    os._exit(codes["none"])
print(json.dumps(codes))
"""


def mutated(mutation: str) -> tuple[str, str, bool]:
    """Return the name of a module, its source with one error in it, and if that is at the tips."""
    at_tips = mutation not in MUTATIONS
    if mutation in WRONG_TIPS:
        file, right, wrong = WRONG_TIPS[mutation]
    else:
        file, before, force = OF_TIPS[mutation] if at_tips else MUTATIONS[mutation]
        file = file if at_tips else f"physics/{file}"
        right, wrong = before + force, f"{before}1.01 * {force}"
    module = f"model.{file.removesuffix('.py').replace('/', '.')}"
    return module, replaced(PROJECT / "src/model" / file, right, wrong), at_tips


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, str]]:
    """(exit code, output) of the unit tests, uncompiled, on each mutation and on none."""
    folder = tmp_path_factory.mktemp("mutated")
    mutations = {name: mutated(name) for name in EVERY}
    # Hypothesis would be imported by every fork that fails, to tell of examples.
    plugins = ["-p", "no:cacheprovider", "-p", "no:hypothesispytest"]
    options = ["-x", "-q", "-s", *plugins, *UNIT_TESTS]
    run = subprocess.run(
        [sys.executable, "-c", RUN_EACH, folder],
        input=json.dumps([mutations, options]),
        cwd=PROJECT,
        env={
            **os.environ,
            "VIBRALIGN_NO_COMPILATION": "1",
            "VIBRALIGN_CACHE": str(folder / "kernels"),
        },
        capture_output=True,
        text=True,
        check=True,
    )
    told = {name: (folder / name).read_text(encoding="utf-8") for name in EVERY}
    told["none"] = run.stdout
    codes = json.loads(run.stdout.splitlines()[-1])
    return {name: (codes[name], told[name]) for name in told}


@pytest.mark.parametrize("mutation", EVERY)
def test_a_unit_test_catches_it(tried: dict[str, tuple[int, str]], mutation: str) -> None:
    code, told = tried[mutation]
    assert code == pytest.ExitCode.TESTS_FAILED, told
    assert "1 failed" in told


def test_without_a_mutation_no_unit_test_fails(tried: dict[str, tuple[int, str]]) -> None:
    code, told = tried["none"]
    assert code == pytest.ExitCode.OK, told
