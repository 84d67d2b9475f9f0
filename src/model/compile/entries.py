"""Entries: kernels as Python calls them, by machine code that is compiled when it is needed.

An entry has one signature for all kernels, (words, result): addresses of eight-byte numbers.
``words`` holds the numbers among the arguments, and of each array its address and first length, in
the order of the arguments; the numbers of the result are written to ``result``. A page calls the
same entries (webassembly.py). The arrays of one call must not overlap.
"""

import ctypes
import functools
import os
import pickle
import struct
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np

from model.compile import cache, machine_code
from model.compile.identity import file_identity
from model.compile.kernels import Function
from model.compile.module import Module, name_of
from model.compile.source import KernelError
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    POINTER,
    ArrayType,
    GroupType,
    StaticType,
    Type,
    leaf_kinds,
)
from model.compile.vector_code import VectorFunction

COMPILES = os.environ.get("VIBRALIGN_NO_COMPILATION", "0") in ("", "0")
"""Whether kernels are compiled. With ``VIBRALIGN_NO_COMPILATION=1`` they run as Python."""

_FORMATS = {DOUBLE: "d", INTEGER: "q", BOOLEAN: "q", POINTER: "Q"}
_KINDS = {"f": DOUBLE, "i": INTEGER}
_NUMBER = 8  # bytes
_COMPILING = threading.Lock()


class Compiled:
    """A kernel as machine code, called from Python as the kernel is.

    Arguments are numbers, arrays of float64 or int64, tuples of these, and static objects: anything
    else, for which the kernel is compiled. Threads may call it at once; they do not hold the global
    interpreter lock.
    """

    def __init__(self, function: Callable[..., Any], contract: bool = True) -> None:
        self.kernel, self._contract = function, contract
        self._natives: dict[tuple[Type, ...], _Native] = {}

    def __call__(self, *arguments: Any) -> Any:
        """Run the kernel."""
        if not COMPILES:
            return self.kernel(*arguments)
        native, words = self.prepared(arguments)
        return native.run(*native.memory(words))

    def prepared(self, arguments: tuple[Any, ...]) -> "tuple[_Native, list[Any]]":
        """Return machine code for these arguments, and their words."""
        words: list[Any] = []
        types = tuple([flattened(each, words) for each in arguments])
        if types not in self._natives:
            self._natives[types] = _native(self.kernel, types, self._contract)
        return self._natives[types], words


def compiled(function: Function, *, contract: bool = True) -> Function:
    """Return a kernel as machine code, which is made or loaded at its first call.

    Without ``contract``, no product and sum become one operation: results have Python's bits.

    Raises:
        KernelError: at the first call, if the kernel is not in the subset.
    """
    return Compiled(function, contract)  # type: ignore[return-value]


def bound(function: Any, *arguments: Any) -> Callable[[], Any]:
    """Return a ``compiled`` kernel with its arguments: a call takes a tenth of the time.

    Numbers keep their values; arrays are read, and written, anew at each call. Only one thread may
    call it at a time.
    """
    if not COMPILES:
        return functools.partial(function, *arguments)
    native, words = function.prepared(arguments)
    memory = native.memory(words)

    def call(_held: tuple[Any, ...] = arguments) -> Any:
        return native.run(*memory)

    return call


def flattened(argument: Any, words: list[Any]) -> Type:
    """Return the type of an argument, and append its words.

    Raises:
        TypeError: an array of other numbers, or of no dimension.
    """
    if isinstance(argument, (bool, np.bool_)):
        words.append(argument)
        return BOOLEAN
    if isinstance(argument, float):
        words.append(argument)
        return DOUBLE
    if isinstance(argument, (int, np.integer)):
        words.append(int(argument))
        return INTEGER
    if isinstance(argument, np.ndarray):
        kind = _KINDS.get(argument.dtype.kind)
        if kind is None or argument.itemsize != _NUMBER or argument.ndim == 0:
            raise TypeError(
                f"an array of {argument.dtype} with {argument.ndim} dimensions: kernels take "
                "float64 or int64 with at least one"
            )
        words += argument.ctypes.data, argument.shape[0]
        strides = tuple([each // _NUMBER for each in argument.strides])
        return ArrayType(kind, (None, *argument.shape[1:]), strides)
    if isinstance(argument, tuple):
        made_by = type(argument) if hasattr(argument, "_fields") else None
        return GroupType(made_by, tuple([flattened(each, words) for each in argument]))
    return StaticType(argument)


class _Native:
    """Loaded machine code of an entry."""

    def __init__(self, address: int, types: tuple[Type, ...], result: Type) -> None:
        self._call = ctypes.CFUNCTYPE(None, ctypes.c_char_p, ctypes.c_char_p)(address)
        self._words = _packing(types)
        self._result, self._numbers = result, _packing((result,))

    def memory(self, words: list[Any]) -> tuple[bytes, Any]:
        """Return the words and room for the result as machine code reads and writes them."""
        return self._words.pack(*words), ctypes.create_string_buffer(self._numbers.size)

    def run(self, packed: bytes, written: Any) -> Any:
        """Run the machine code and return its result."""
        self._call(packed, written)
        return _rebuilt(self._result, iter(self._numbers.unpack(written)))


def _packing(types: tuple[Type, ...]) -> struct.Struct:
    kinds = (kind for each in types for kind in leaf_kinds(each))
    return struct.Struct("".join(["=", *(_FORMATS[kind] for kind in kinds)]))


def _rebuilt(type_: Type, numbers: Iterator[Any]) -> Any:
    """Return the value of Python whose numbers are given; an empty tuple is None."""
    if isinstance(type_, GroupType):
        items = [_rebuilt(each, numbers) for each in type_.items]
        return (type_.made_by(*items) if type_.made_by else tuple(items)) if items else None
    return bool(next(numbers)) if type_ == BOOLEAN else next(numbers)


# --- From a kernel to loaded machine code ---------------------------------------------------------


class _Stored(NamedTuple):
    """An object as the cache holds it.

    Attributes:
        name: of its function.
        header: ``parts``: names of the objects to be loaded before it, in order; ``files``: digests
            of the files outside the package from which it is made; ``result``: its type, pickled.
        code: the object.
    """

    name: str
    header: dict[str, Any]
    code: bytes


def _native(function: Callable[..., Any], types: tuple[Type, ...], contract: bool) -> _Native:
    with _COMPILING:
        key = function, types
        stored = _all_stored(name_of(key, is_entry=True, contract=contract))
        if stored is None:
            try:
                module = Module(key, {}, is_entry=True, contract=contract)
            except KernelError as error:
                raise error.with_traceback(None) from None  # the compiler's own calls tell nothing
            stored = _made(module)
        for each in stored:
            address = machine_code.load(each.name, each.code)
        result = pickle.loads(bytes.fromhex(stored[-1].header["result"]))  # noqa: S301 - from _made
        return _Native(address, types, result)


def address_of(function: VectorFunction) -> int:
    """Return the address of the machine code of a function of vectors."""
    with _COMPILING:
        (stored,) = _all_stored(function.name) or _made(function)
        return machine_code.load(function.name, stored.code)


def _all_stored(name: str) -> list[_Stored] | None:
    """Return the stored objects of a function's parts and its own; None if one is missing."""
    found = cache.read(name)
    if found is None or any(file_identity(file) != of for file, of in found[0]["files"].items()):
        return None
    objects = []
    for each in found[0]["parts"]:
        part = cache.read(each)
        if part is None:
            return None
        objects.append(_Stored(each, *part))
    return [*objects, _Stored(name, *found)]


def _made(module: Module | VectorFunction) -> list[_Stored]:
    """Compile and store a module and its parts, but for those that are stored already."""
    modules = [*module.linked()]
    kept = {each.name: cache.read(each.name) for each in modules}
    missing = [each for each in modules if kept[each.name] is None]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = pool.map(
            lambda each: machine_code.object_of(each.text(), each.is_vector), missing
        )
        for each, code in zip(missing, objects, strict=True):
            header = {
                "parts": [part.name for part in each.linked()][:-1],
                "files": {file: file_identity(file) for file in sorted(each.files)},
                "result": pickle.dumps(each.result).hex(),
            }
            kept[each.name] = header, code
            cache.write(each.name, header, code)
    return [_Stored(each.name, *kept[each.name]) for each in modules]  # type: ignore[misc]


def _object_of(module: Module | VectorFunction) -> bytes:
    return machine_code.object_of(module.text(), module.is_vector)
