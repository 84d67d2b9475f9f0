"""Functions generated as Python source, which debuggers and tracebacks show.

The source of each function is a file beside the compiled kernels, and is registered with
``linecache``.
"""

import contextlib
import hashlib
import linecache
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from model.compile.cache import cache_folder
from model.compile.jit import inlined_kernel, python_of

Lines = Iterator[str]
_SOURCES = cache_folder() / "sources"


def defined(name: str, code: str, known: Mapping[str, Any], label: str = "") -> Any:
    """Return the function ``name`` that the Python source ``code`` defines.

    ``known`` holds the objects that the source refers to, by name; ``label`` distinguishes
    functions of the same name.
    """
    namespace = {"__name__": __name__, **known}
    full_name = f"{label}.{name}" if label else name
    exec(compile(code, _kept(full_name, code), "exec"), namespace)  # noqa: S102 - our own source
    function = namespace[name]
    function.__qualname__ = full_name
    return function


def _kept(name: str, code: str) -> str:
    """Write a source to a file named by its hash, unless it is there whole; return the path."""
    digest = hashlib.sha256(code.encode()).hexdigest()[:16]
    path = _SOURCES / f"{name}-{digest}.py"
    linecache.cache[str(path)] = len(code), None, code.splitlines(keepends=True), str(path)
    with contextlib.suppress(OSError):  # a read-only folder: linecache holds the lines
        if not path.exists() or path.stat().st_size != len(code.encode()):
            _SOURCES.mkdir(exist_ok=True)
            with tempfile.NamedTemporaryFile("w", dir=_SOURCES, delete=False) as file:
                file.write(code)
            Path(file.name).replace(path)
    return str(path)


def is_generated(function: Callable[..., Any]) -> bool:
    """Return whether ``defined`` has made this function or kernel."""
    return Path(python_of(function).__code__.co_filename).parent == _SOURCES


class Writer:
    """Generator of kernels as Python source, which call other kernels by generated names.

    Attributes:
        label: distinguishes its kernels from others of the same names; see ``defined``.
        known: objects that the code refers to, by name.
        members: kernels generated so far, by name.
        sources: files that define the called kernels.
    """

    def __init__(self, label: str, **known: Any) -> None:
        self.label = label
        self.known: dict[str, Any] = known
        self.members: dict[str, Any] = {}
        self.sources: set[str] = set()

    def name(self, function: Callable[..., Any]) -> str:
        """Return the name of a kernel in the code."""
        for name, known in self.known.items():
            if known is function:
                return name
        name = f"_{len(self.known)}_{python_of(function).__name__.lstrip('_')}"
        self.known[name] = function
        if not is_generated(function):
            self.sources.add(python_of(function).__code__.co_filename)
        return name

    def write(self, compiled: Callable[..., Any], head: str, lines: Lines) -> None:
        """Make the kernel with the signature ``head`` and these lines, by ``compiled``."""
        code = "\n".join([f"def {head}:", *(f"    {each}" for each in lines)])
        name = head[: head.index("(")]
        self.members[name] = compiled(defined(name, code, self.known, self.label))
        self.known[name] = self.members[name]

    def choose(self, head: str, choices: Iterator[tuple[int, str]], otherwise: str) -> None:
        """Make a kernel that returns the choice with the number ``which``, or ``otherwise``."""

        def lines() -> Lines:
            for number, expression in choices:
                yield f"if which == {number}: return {expression}"
            yield f"return {otherwise}"

        self.write(inlined_kernel, head, lines())
