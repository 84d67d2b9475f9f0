"""Kernels generated as Python source."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from model.compile.jit import inlined_kernel, python_of

Lines = Iterator[str]


def generated(
    compiled: Callable[..., Any], name: str, code: str, known: Mapping[str, Any], label: str
) -> Any:
    """Return the kernel ``name`` that the Python source ``code`` defines.

    Args:
        compiled: ``kernel`` or ``inlined_kernel``.
        name: name of the function.
        code: source of the function.
        known: objects that the source refers to, by name.
        label: distinguishes kernels of the same name generated for different tables.
    """
    namespace = dict(known)
    exec(compile(code, __file__, "exec"), namespace)  # noqa: S102 - the source is our own
    function = namespace[name]
    function.__qualname__, function.__module__ = f"{label}.{name}", __name__
    return compiled(function)


class Writer:
    """Generator of kernels as Python source, which call other kernels by generated names.

    Attributes:
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
        self.sources.add(python_of(function).__code__.co_filename)
        return name

    def write(self, compiled: Callable[..., Any], head: str, lines: Lines) -> None:
        """Make the kernel that begins with ``head`` and has these lines."""
        code = "\n".join([f"def {head}:", *(f"    {each}" for each in lines)])
        name = head[: head.index("(")]
        self.members[name] = generated(compiled, name, code, self.known, self.label)
        self.known[name] = self.members[name]

    def choose(self, head: str, choices: Iterator[tuple[int, str]], otherwise: str) -> None:
        """Make a kernel of ``which`` that returns another expression for each event."""

        def lines() -> Lines:
            for number, expression in choices:
                yield f"if which == {number}: return {expression}"
            yield f"return {otherwise}"

        self.write(inlined_kernel, head, lines())
