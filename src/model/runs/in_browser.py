"""The engines as WebAssembly modules, for a page that runs them: the scalar and the batch engine.

A page calls the same entries as Python (compile/entries.py), with arrays in its own memory;
``interface`` tells their lengths, and the names of their columns.
"""

import contextlib
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.cache import cache_folder
from model.compile.entries import flattened
from model.compile.identity import PACKAGE, digest_of
from model.compile.kernels import inlined_kernel, kernel
from model.compile.webassembly import web_assembly_of
from model.engine.lane_events import lane_events_of
from model.engine.lifecycle import Control
from model.engine.results import RunResult
from model.engine.scalar.loop import new_scalar_memory
from model.engine.scheduling import begin_all, integrate_all, new_batch_memory
from model.events.insertion import INSERTION
from model.events.kernels import SceneEvents, in_kernels
from model.events.scenes import ALIGNMENT, Scene
from model.physics.parameters import PARAMETER_NAMES, Constants, Given, Shape, resolved
from model.runs.settings import SCENES, Settings
from model.runs.trace import COLUMNS, integrate_trace

# ------------------------------------------------------------------------------------------ kernels


@inlined_kernel
def _resolve(given, constants):
    """Write the ``Constants`` of the parameters ``given``, consistent variants."""
    found = resolved(Given(*(given[n] for n in range(len(PARAMETER_NAMES)))))
    for n, value in enumerate(found):
        constants[n] = value


@inlined_kernel
def _control_in(limits):
    """Return the ``Control`` after the tolerance in ``limits``."""
    return Control(*(limits[1 + n] for n in range(len(Control._fields))))


def _run_one(scene: SceneEvents) -> Any:
    """Make the kernel that runs one set and fills its track."""

    @kernel
    def run_one(given, limits, track, queue, results, constants, memory):
        _resolve(given[0], constants)
        control = _control_in(limits)
        integrate_trace(constants, limits[0], scene, control, track, results, memory, queue)

    return run_one


def _run_many(scene: SceneEvents) -> Any:
    """Make the kernel that runs any number of sets."""
    lanes = lane_events_of(scene.events)
    lanes = replace(lanes, series=lanes.series.resident())

    @kernel
    def run_many(given, limits, results, constants, tolerances, queue, memory):
        for n in range(given.shape[0]):
            _resolve(given[n], constants[n])
            tolerances[n] = limits[0]
        queue[0], queue[1] = 0, given.shape[0]
        control = _control_in(limits)
        begin_all(constants, tolerances, scene, lanes, control, queue, results, memory)
        integrate_all(constants, tolerances, scene, lanes, control, queue, results, memory)

    return run_many


# ------------------------------------------------------------------------------------- declarations

_CONSTANTS, _RESULTS, _GIVEN = len(Constants._fields), len(RunResult._fields), len(PARAMETER_NAMES)


class _Declared(NamedTuple):
    """A function of the page.

    Attributes:
        kernel: the kernel that it is made of.
        arguments: its arguments by name, as arrays of the right shapes.
        lengths: "sets" or "rows" for arguments whose first length the page chooses.
    """

    kernel: Any
    arguments: dict[str, Any]
    lengths: dict[str, str]


def _declared(is_round: bool, scene: Scene) -> dict[str, _Declared]:
    """Return the functions: ``run_one`` has the scene, ``run_many`` ends at alignment."""
    own, aligning = (in_kernels(each, is_round) for each in (scene, ALIGNMENT))
    given, limits = np.zeros((1, _GIVEN)), np.zeros(1 + len(Control._fields))
    results = np.zeros((1, _RESULTS))
    one = {
        "given": given, "limits": limits, "track": np.zeros((1, len(COLUMNS))),
        "queue": np.zeros(3, np.int64), "results": results, "constants": np.zeros(_CONSTANTS),
        "memory": new_scalar_memory(),
    }  # fmt: skip
    lanes = lane_events_of(aligning.events)
    many = {
        "given": given, "limits": limits, "results": results,
        "constants": np.zeros((1, _CONSTANTS)), "tolerances": np.zeros(1),
        "queue": np.zeros(3, np.int64), "memory": new_batch_memory(lanes),
    }  # fmt: skip
    sets = dict.fromkeys(("given", "results"), "sets")
    return {
        "run_one": _Declared(_run_one(own), one, sets | {"track": "rows"}),
        "run_many": _Declared(
            _run_many(aligning), many, sets | dict.fromkeys(("constants", "tolerances"), "sets")
        ),
    }


def _arrays_in(name: str, value: Any) -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the arrays of an argument with their names, in the order of an entry's words."""
    if isinstance(value, np.ndarray):
        yield name, value
    else:
        for field, each in value._asdict().items():
            yield from _arrays_in(f"{name}.{field}", each)


def _layout(function: _Declared) -> list[dict[str, Any]]:
    """Return the arguments as a page allocates them: first length, and numbers for each of it."""
    return [
        {
            "name": name,
            "length": function.lengths.get(name, array.shape[0]),
            "size": int(np.prod(array.shape[1:])),
        }
        for argument, value in function.arguments.items()
        for name, array in _arrays_in(argument, value)
    ]


# ------------------------------------------------------------------------------------------ modules


class Modules(NamedTuple):
    """The two engines as WebAssembly, and the ``interface`` by which a page calls them."""

    run_one: bytes
    run_many: bytes
    interface: dict[str, Any]


def interface(scene: Scene = INSERTION, shape: Shape = "square") -> dict[str, Any]:
    """Return the names and numbers with which a page calls the engines and reads their results."""
    events = in_kernels(scene, shape == "round").events
    return {
        "shape": shape,
        "parameters": PARAMETER_NAMES,
        "columns": COLUMNS,
        "results": RunResult._fields,
        "limits": ["tolerance", *Control._fields],
        "defaults": [Settings().tolerance, *Settings().control],
        "events": [each.event.name for each in events.all],
    }


WIDTH_OF_PAGES = 2  # WebAssembly's vectors have 128 bits (decision 61)


def _compile_apart(folder: Path, shape: Shape, scene: Scene) -> None:
    """Write the modules and their interface into ``folder``, from a process of their own width."""
    paths = [str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")]
    variables = {"VIBRALIGN_WIDTH": str(WIDTH_OF_PAGES), "PYTHONPATH": os.pathsep.join(paths)}
    program = "from model.runs.in_browser import _compile; import pathlib, sys; "
    program += "_compile(pathlib.Path(sys.argv[1]), *sys.argv[2:])"
    arguments = [sys.executable, "-c", program, str(folder), shape, scene.name]
    subprocess.run(arguments, env={**os.environ, **variables}, check=True)


def _compile(folder: Path, shape: Shape, scene_name: str) -> None:
    """Write the modules and their interface into ``folder``."""
    scene = SCENES[scene_name]
    table = interface(scene, shape) | {"functions": {}}
    for name, function in _declared(shape == "round", scene).items():
        types = tuple(flattened(each, []) for each in function.arguments.values())
        made = web_assembly_of((function.kernel, types))
        sha256 = hashlib.sha256(made.binary).hexdigest()
        arguments = _layout(function)
        stated = {"stack": made.stack, "arguments": arguments, "sha256": sha256}
        table["functions"][name] = stated
        (folder / f"{name}.wasm").write_bytes(made.binary)
    (folder / "interface.json").write_text(json.dumps(table))


def _folder(shape: Shape, scene: Scene) -> Path:
    digest = digest_of(_compile, WIDTH_OF_PAGES, shape, scene.name)
    return cache_folder() / "webassembly" / f"{shape}_{scene.name}_{digest}"


def are_cached(shape: Shape = "square", scene: Scene = INSERTION) -> bool:
    """Return whether the modules are compiled already."""
    return _folder(shape, scene).exists()


def modules(shape: Shape = "square", scene: Scene = INSERTION) -> Modules:
    """Return the modules for parts of a shape in a scene, compiled unless they are cached.

    Raises:
        OSError: no folder for temporary files can be written.
    """
    folder = _folder(shape, scene)
    if (kept := _kept(folder)) is not None:
        return kept
    with tempfile.TemporaryDirectory() as made:
        _compile_apart(Path(made), shape, scene)
        compiled = _kept(Path(made))
        with contextlib.suppress(OSError):  # a read-only cache, or another process was faster
            shutil.rmtree(folder, ignore_errors=True)  # damaged
            shutil.copytree(made, folder)
    assert compiled is not None  # noqa: S101 - written just now
    return compiled


def _kept(folder: Path) -> Modules | None:
    """Return the modules in a folder, None if one is missing or not as it was written."""
    try:
        table = json.loads((folder / "interface.json").read_text())
        found = {name: (folder / f"{name}.wasm").read_bytes() for name in table["functions"]}
        for name, module in found.items():
            if hashlib.sha256(module).hexdigest() != table["functions"][name]["sha256"]:
                return None
        return Modules(**found, interface=table)
    except (OSError, ValueError, LookupError, TypeError):
        return None
