"""Kernels from source text: for tests that make programs, and for those that must be refused."""

import importlib.util
import itertools
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from model.compile.entries import compiled

PRELUDE = """\
import math
from math import floor, inf, isfinite, isnan, nan, sqrt
from typing import NamedTuple

import numpy as np

from model.compile.builtins import fetch_add
from model.compile.kernels import inlined_kernel, kernel, separate_kernel
from model.compile.vector_code import WIDTH, each_lane


class Point(NamedTuple):
    x: float
    n: int
    flag: bool = False


class Pair(NamedTuple):
    x: float
    y: float


"""
_FOLDER = tempfile.TemporaryDirectory()
_NUMBERS = itertools.count()


def load(text: str, folder: Path | None = None) -> ModuleType:
    """Return a new module with this text after the prelude."""
    name = f"kernels_from_text_{next(_NUMBERS)}"
    path = Path(folder or _FOLDER.name) / f"{name}.py"
    path.write_text(PRELUDE + text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def kernel_of(body: str, parameters: str = "", before: str = "") -> Callable[..., Any]:
    """Return the kernel of this body, after other definitions."""
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    found: Callable[..., Any] = load(
        f"{before}\n\n@kernel\ndef tried({parameters}):\n{lines}"
    ).tried
    return found


def exactly(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a kernel as machine code without fused operations."""
    return compiled(function, contract=False)


def bits(value: Any) -> Any:
    """Return a value in a form that is equal for equal bits; all NaN are the same."""
    if isinstance(value, tuple):
        return type(value).__name__, *map(bits, value)
    if isinstance(value, np.ndarray) and value.ndim:
        return value.shape, *map(bits, value.ravel().tolist())
    if isinstance(value, np.ndarray | np.generic):
        value = value.item()
    return value.hex() if isinstance(value, float) else value
