"""The engines as WebAssembly modules, for a page that runs them: the scalar and the batch engine.

``python -m model.runs.in_browser FOLDER`` compiles them in a process of its own, and so does
``modules`` where they are not cached. The functions take pointers into the memory of the page;
shapes and columns are in ``interface``.
"""

import contextlib
import gc
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import types

from model.compile.cache import cache_folder
from model.compile.generated_kernels import GeneratedKernels
from model.compile.kernels import kernel
from model.compile.source import defined
from model.compile.views import reader, writer
from model.compile.webassembly import NUMBERS, Function, array_at, compile_modules, whole_numbers
from model.engines.batch.event_kernels import in_vector_kernels
from model.engines.batch.event_search import SearchMemory
from model.engines.batch.scheduling import BatchMemory, Waiting, integrate_all, new_batch_memory
from model.engines.lifecycle import Control, History
from model.engines.record import store_result
from model.engines.results import RunResult
from model.engines.scalar.loop import ScalarMemory, Workspace, new_scalar_memory
from model.engines.scalar.tableaux import DOP853
from model.events.insertion import INSERTION
from model.events.kernels import SceneKernels, in_kernels
from model.events.scenes import ALIGNMENT, Scene
from model.physics.parameters import PARAMETER_NAMES, Constants, Given, resolved
from model.runs.settings import Settings
from model.runs.trace import COLUMNS, integrate_trace

_control_in = reader(Control, "control", "control[{} + 1]".format)
_read_given = reader(Given, "given", "given[{}]".format)
_write_constants = writer(Constants, "row", "row[{}]".format)


# --- Kernels ------------------------------------------------------------------------------------


@kernel
def _resolve(given, row):
    """Write the ``Constants`` of the parameters ``given`` into ``row``, consistent variants."""
    _write_constants(resolved(_read_given(given)), row)


# --- Exported functions -------------------------------------------------------------------------


def _memory_of(value: Any, offset: int = 0) -> tuple[str, int]:
    """Return the code that makes a value like ``value`` in ``memory`` at ``offset``, and its end.

    ``value`` is an array, or a named tuple of arrays and of such tuples.
    """
    if isinstance(value, tuple):
        parts = []
        for each in value:
            part, offset = _memory_of(each, offset)
            parts.append(part)
        return f"{type(value).__name__}({', '.join(parts)})", offset
    pointer = "memory" if value.dtype == np.float64 else "whole_numbers(memory)"
    first = -(-offset // 8) * 8  # a cache line
    return f"array_at({pointer}, {first}, {value.shape!r})", first + int(value.size)


_ARGUMENTS: dict[str, Any] = dict.fromkeys(
    ("given", "control", "rows", "out", "results", "memory"), NUMBERS
)
_ARGUMENTS["rows"] = types.int32
_TUPLES: tuple[Any, ...] = (ScalarMemory, Workspace, BatchMemory, SearchMemory, History, Waiting)
_KERNELS: tuple[Any, ...] = (
    array_at,
    whole_numbers,
    _resolve,
    integrate_trace,
    integrate_all,
    store_result,
)


def _function(name: str, size: int, lines: list[str], scene: SceneKernels) -> Function:
    """Make an exported function from its lines; it first zeroes its memory, ``size`` numbers."""
    known: dict[str, Any] = {each.__name__: each for each in (*_TUPLES, *_KERNELS)}
    known |= {"scene": scene, "method": DOP853.method, "control_in": _control_in}
    head = [f"def {name}({', '.join(_ARGUMENTS)}):", f"array_at(memory, 0, ({size},))[:] = 0.0"]
    code = "\n    ".join([*head, *lines])
    return Function(name, defined(name, code, known), tuple(_ARGUMENTS.values()))


_CONSTANTS, _RESULTS, _GIVEN = len(Constants._fields), len(RunResult._fields), len(PARAMETER_NAMES)


def _scalar(scene: Scene) -> tuple[Function, int]:
    """Return ``run_one`` and the size of its memory.

    It runs one set; ``out`` is the track, shape (``rows``, columns).
    """
    single, size = _memory_of(new_scalar_memory(DOP853.method), _CONSTANTS)
    lines = [
        f"row = array_at(memory, 0, ({_CONSTANTS},))",
        f"_resolve(array_at(given, 0, ({_GIVEN},)), row)",
        f"single, track = {single}, array_at(out, 0, (rows, {len(COLUMNS)}))",
        "integrate_trace(row, control[0], scene, method, control_in(control), track, single)",
        f"store_result(single.runs, 0, array_at(results, 0, (1, {_RESULTS})), 0)",
    ]
    return _function("run_one", size, lines, in_kernels(scene)), size


@kernel
def _fill_no_errors(_kind, _block, _coefficients, _given, _error):
    """Replace ``fill_errors``, a fifth of the page's size: runs of the page carry no error."""


def _batch(scene: Scene) -> tuple[Function, int]:
    """Return ``run_many`` and the size of its memory.

    It runs ``rows`` sets; ``out`` is room for their constants and tolerances.
    """
    kernels = in_vector_kernels(scene)
    members = kernels.events.members | {"fill_errors": _fill_no_errors}
    events = GeneratedKernels(f"{kernels.events.name}-without-errors", members, set())
    kernels = kernels._replace(events=events)
    many, size = _memory_of(new_batch_memory(kernels), 8)
    lines = [
        f"sets = array_at(given, 0, (rows, {_GIVEN}))",
        f"constants = array_at(out, 0, (rows, {_CONSTANTS}))",
        f"tolerances = array_at(out, rows * {_CONSTANTS}, (rows,))",
        "for i in range(rows):",
        "    _resolve(sets[i], constants[i])",
        "    tolerances[i] = control[0]",
        "queue = array_at(whole_numbers(memory), 0, (2,))",
        "queue[0], queue[1] = 0, rows",
        f"ends = array_at(results, 0, (rows, {_RESULTS}))",
        f"many, limits = {many}, control_in(control)",
        "integrate_all(constants, tolerances, scene, method, limits, queue, ends, many)",
    ]
    return _function("run_many", size, lines, kernels), size


# --- Modules ------------------------------------------------------------------------------------


class Modules(NamedTuple):
    """The two engines as WebAssembly, and the ``interface`` by which a page calls them."""

    run_one: bytes
    run_many: bytes
    interface: dict[str, Any]


def interface(scene: Scene = INSERTION) -> dict[str, Any]:
    """Return the names and numbers with which a page calls the engines and reads their results."""
    return {
        "parameters": PARAMETER_NAMES,
        "columns": COLUMNS,
        "results": RunResult._fields,
        "control": ["tolerance", *Control._fields],
        "defaults": [Settings().tolerance, *Settings().control],
        "events": [each.name for each in scene.events],
        "constants": _CONSTANTS,
    }


def _compile(folder: Path) -> None:
    """Write the modules and their interface into ``folder``.

    ``run_one``, for the animation of a run, has the insertion scene; ``run_many``, for maps, ends
    at alignment.
    """
    made = _scalar(INSERTION), _batch(ALIGNMENT)
    table = interface() | {"functions": {}}
    compiled = compile_modules([function for function, _ in made])
    for (function, size), module in zip(made, compiled, strict=True):
        sha256 = hashlib.sha256(module.binary).hexdigest()
        stated = {"stack": module.stack, "memory": size, "sha256": sha256}
        table["functions"][function.name] = stated
        (folder / f"{function.name}.wasm").write_bytes(module.binary)
    (folder / "interface.json").write_text(json.dumps(table))


def _folder() -> Path:
    return cache_folder() / "webassembly"


def are_cached() -> bool:
    """Return whether the modules are compiled already."""
    return _folder().exists()


def modules() -> Modules:
    """Return the modules, compiled in a process of their own unless they are cached.

    Raises:
        RuntimeError: they do not compile; the message holds the compiler's.
    """
    folder = _folder()
    if (kept := _kept(folder)) is not None:
        return kept
    shutil.rmtree(folder, ignore_errors=True)  # damaged
    with tempfile.TemporaryDirectory(dir=folder.parent, ignore_cleanup_errors=True) as made:
        command = [sys.executable, "-m", "model.runs.in_browser", made]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"the engines did not compile to WebAssembly:\n{done.stderr}")
        kept = _kept(Path(made))
        with contextlib.suppress(OSError):  # another process was faster
            Path(made).rename(folder)
    if kept is None:
        raise RuntimeError(f"the engines for the page cannot be kept in {folder.parent}")
    return kept


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


if __name__ == "__main__":
    gc.disable()  # as in jit.py
    _compile(Path(sys.argv[1]))
