"""Sets of generated kernels, each with a numba type of its own, for which callers are compiled."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

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

from model.compile.cache import PACKAGE

_SETS: dict[str, "GeneratedKernels"] = {}


class GeneratedKernels:
    """Set of kernels and integers, passed to other kernels as one argument.

    A kernel that takes a set is compiled for this set: its integers are constants, and its kernels
    can be inlined. At run time a set is no data.

    Args:
        name: name of the set; sets of the same name have the same type.
        members: kernels and integers by name.
        sources: files that define the members. The contents of files outside the package become
            part of the name, since the cache of compiled kernels is keyed by the package's files.
    """

    def __init__(self, name: str, members: Mapping[str, Any], sources: set[str]) -> None:
        digest = hashlib.sha256()
        outside = sorted(each for each in sources if PACKAGE not in Path(each).resolve().parents)
        for source in outside:
            digest.update(Path(source).read_bytes())
        self.name = f"{name}-{digest.hexdigest()[:16]}" if outside else name
        self.__dict__.update(members)
        self.members = dict(members)
        self.type = GeneratedKernelsType(self.name)
        _SETS[self.name] = self

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"the kernels of {self.__dict__.get('name')!r} have no {name!r}")


class GeneratedKernelsType(types.Type):
    """numba's type of a ``GeneratedKernels``."""

    def __init__(self, set_name: str) -> None:
        self.set_name = set_name
        super().__init__(name=f"GeneratedKernels({set_name})")


register_model(GeneratedKernelsType)(models.OpaqueModel)


@typeof_impl.register(GeneratedKernels)
def _type_of(kernels: GeneratedKernels, _context: Any) -> GeneratedKernelsType:
    return kernels.type  # without this, numba takes 0.2 ms a call to find the type


@unbox(GeneratedKernelsType)
def _unbox(_type: Any, _value: Any, context: Any) -> NativeValue:
    return NativeValue(context.context.get_dummy_value())


@lower_constant(GeneratedKernelsType)
def _constant(context: Any, _builder: Any, _type: Any, _value: Any) -> Any:
    return context.get_dummy_value()


@infer_getattr
class _Members(AttributeTemplate):
    key = GeneratedKernelsType

    def generic_resolve(self, kernels: Any, name: str) -> Any:  # type: ignore[override]
        member = _SETS[kernels.set_name].members.get(name)
        if isinstance(member, int):
            return types.intp
        return None if member is None else member._numba_type_


@lower_getattr_generic(GeneratedKernelsType)
def _member(context: Any, _builder: Any, kernels: Any, _value: Any, name: str) -> Any:
    member = _SETS[kernels.set_name].members[name]
    if isinstance(member, int):
        return context.get_constant(types.intp, member)
    return context.get_dummy_value()
