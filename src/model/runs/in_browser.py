"""The engine as a WebAssembly module, for a page that runs it.

A page calls the same entry as Python (compile/entries.py), with arrays in its own memory;
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
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.compile.cache import cache_folder
from model.compile.entries import flattened
from model.compile.identity import PACKAGE, digest_of
from model.compile.kernels import inlined_kernel, kernel
from model.compile.webassembly import web_assembly_of
from model.engine.lane_events import LaneEvents, lane_events_of
from model.engine.lifecycle import Control
from model.engine.results import RunResult
from model.engine.scheduling import begin_all, integrate_all, new_memory
from model.engine.track import COLUMNS
from model.events.insertion import INSERTION
from model.events.kernels import SceneEvents, in_kernels
from model.events.scenes import Scene
from model.physics.parameters import PARAMETER_NAMES, Constants, Given, Shape, resolved
from model.runs.settings import SCENES, Settings

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


def _run(scene: SceneEvents, lanes: LaneEvents) -> Any:
    """Make the kernel that runs any number of sets, a single one with its track."""

    @kernel
    def run(given, limits, results, constants, tolerances, queue, memory):
        for n in range(given.shape[0]):
            _resolve(given[n], constants[n])
            tolerances[n] = limits[0]
        queue[0], queue[1] = 0, given.shape[0]
        control = _control_in(limits)
        begin_all(constants, tolerances, scene, lanes, control, queue, results, memory)
        integrate_all(constants, tolerances, scene, lanes, control, queue, results, memory)

    return run


# ------------------------------------------------------------------------------------- declarations

# Arguments whose first length the page chooses: the sets, and the rows of a track.
_LENGTHS = {
    **dict.fromkeys(("given", "results", "constants", "tolerances"), "sets"),
    "memory.track": "rows",
}


class _Declared(NamedTuple):
    """The function of the page: its kernel, and its arguments as arrays of the right shapes."""

    kernel: Any
    arguments: dict[str, Any]


def _declared(is_round: bool, scene: Scene) -> _Declared:
    """Return the function, of a scene."""
    declared = in_kernels(scene, is_round)
    lanes = lane_events_of(declared.events, is_resident=True)
    return _Declared(
        _run(declared, lanes),
        {
            "given": np.zeros((1, len(PARAMETER_NAMES))),
            "limits": np.zeros(1 + len(Control._fields)),
            "results": np.zeros((1, len(RunResult._fields))),
            "constants": np.zeros((1, len(Constants._fields))),
            "tolerances": np.zeros(1),
            "queue": np.zeros(3, np.int64),
            "memory": new_memory(lanes),
        },
    )


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
            "length": _LENGTHS.get(name, array.shape[0]),
            "size": int(np.prod(array.shape[1:])),
        }
        for argument, value in function.arguments.items()
        for name, array in _arrays_in(argument, value)
    ]


# ------------------------------------------------------------------------------------------ modules


class Module(NamedTuple):
    """The engine as WebAssembly, and the ``interface`` by which a page calls it."""

    binary: bytes
    interface: dict[str, Any]


def interface(scene: Scene = INSERTION, shape: Shape = "square") -> dict[str, Any]:
    """Return the names and numbers with which a page calls the engine and reads its results."""
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
    """Write the module and its interface into ``folder``."""
    scene = SCENES[scene_name]
    function = _declared(shape == "round", scene)
    types = tuple(flattened(each, []) for each in function.arguments.values())
    made = web_assembly_of((function.kernel, types))
    sha256 = hashlib.sha256(made.binary).hexdigest()
    stated = {"stack": made.stack, "arguments": _layout(function), "sha256": sha256}
    (folder / "engine.wasm").write_bytes(made.binary)
    (folder / "interface.json").write_text(json.dumps(interface(scene, shape) | stated))


def _folder(shape: Shape, scene: Scene) -> Path:
    digest = digest_of(_compile, WIDTH_OF_PAGES, shape, scene.name)
    return cache_folder() / "webassembly" / f"{shape}_{scene.name}_{digest}"


def is_cached(shape: Shape = "square", scene: Scene = INSERTION) -> bool:
    """Return whether the module is compiled already."""
    return _folder(shape, scene).exists()


def module_for(shape: Shape = "square", scene: Scene = INSERTION) -> Module:
    """Return the module for parts of a shape in a scene, compiled unless it is cached.

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


def _kept(folder: Path) -> Module | None:
    """Return the module in a folder, None if it is missing or not as it was written."""
    try:
        table = json.loads((folder / "interface.json").read_text())
        binary = (folder / "engine.wasm").read_bytes()
        if hashlib.sha256(binary).hexdigest() != table["sha256"]:
            return None
        return Module(binary, table)
    except (OSError, ValueError, LookupError, TypeError):
        return None
