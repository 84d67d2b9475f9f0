"""Sets of kernels as types: callers are compiled for the set that they are given."""

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from numba.core import types
from numba.core.imputils import lower_constant
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

_PACKAGE = Path(__file__).resolve().parents[1]
_SETS: dict[str, "KernelSet"] = {}
Decorator = TypeVar("Decorator", bound=Callable[..., Any])


class KernelSet:
    """Kernels and whole numbers by name, passed to kernels as one argument.

    A kernel that takes a set is compiled for it: numbers of the set are constants, and kernels of
    the set can be inlined. A set holds no data at run time.

    Args:
        name: name of the set; sets of the same name have the same type.
        members: kernels and whole numbers by name.
        sources: files that define the members. The contents of files outside the package become
            part of the name, since the cache of compiled kernels is keyed by the package's files.
    """

    def __init__(self, name: str, members: Mapping[str, Any], sources: set[str]) -> None:
        digest = hashlib.sha256()
        outside = sorted(each for each in sources if _PACKAGE not in Path(each).resolve().parents)
        for source in outside:
            digest.update(Path(source).read_bytes())
        self.name = f"{name}-{digest.hexdigest()[:16]}" if outside else name
        self.__dict__.update(members)
        self.members = dict(members)
        self.type = KernelSetType(self.name)
        _SETS[self.name] = self

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"the kernels of {self.__dict__.get('name')!r} have no {name!r}")


class KernelSetType(types.Type):
    """numba's type of a ``KernelSet``."""

    def __init__(self, set_name: str) -> None:
        self.set_name = set_name
        super().__init__(name=f"KernelSet({set_name})")


register_model(KernelSetType)(models.OpaqueModel)


@typeof_impl.register(KernelSet)
def _type_of(kernel_set: KernelSet, _context: Any) -> KernelSetType:
    return kernel_set.type  # numba's own way to it takes 0.2 ms a call


@unbox(KernelSetType)
def _unbox(_type: Any, _value: Any, context: Any) -> NativeValue:
    return NativeValue(context.context.get_dummy_value())


@lower_constant(KernelSetType)
def _constant(context: Any, _builder: Any, _type: Any, _value: Any) -> Any:
    return context.get_dummy_value()


@infer_getattr
class _Members(AttributeTemplate):
    key = KernelSetType

    def generic_resolve(self, kernel_set: Any, name: str) -> Any:  # type: ignore[override]
        member = _SETS[kernel_set.set_name].members.get(name)
        if isinstance(member, int):
            return types.intp
        return None if member is None else member._numba_type_


@lower_getattr_generic(KernelSetType)
def _member(context: Any, _builder: Any, kernel_set: Any, _value: Any, name: str) -> Any:
    member = _SETS[kernel_set.set_name].members[name]
    if isinstance(member, int):
        return context.get_constant(types.intp, member)
    return context.get_dummy_value()


def generated(
    compiled: Decorator, name: str, code: str, known: Mapping[str, Any], label: str
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
