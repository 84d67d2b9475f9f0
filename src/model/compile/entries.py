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
from typing import Any, NamedTuple

import numpy as np

from model.compile import cache, machine_code
from model.compile.code import BEYOND, CHECKED
from model.compile.kernels import Function, python_of
from model.compile.module import Key, Module, name_of
from model.compile.source import KernelError
from model.compile.values import (
    BOOLEAN,
    DOUBLE,
    INTEGER,
    POINTER,
    Array,
    Group,
    Number,
    Static,
    SubsetError,
    Type,
    element_kind,
    element_strides,
    leaf_kinds,
)
from model.compile.vector_code import VectorFunction

COMPILES = os.environ.get("VIBRALIGN_NO_COMPILATION", "0") in ("", "0")
"""True if kernels are compiled. With ``VIBRALIGN_NO_COMPILATION=1`` they run as Python."""

_FORMATS = {DOUBLE: "d", INTEGER: "q", BOOLEAN: "q", POINTER: "Q"}
_BOOL, _INT, _FLOAT = Number(BOOLEAN), Number(INTEGER), Number(DOUBLE)
_COMPILING = threading.RLock()
_PARTS: dict[bool, dict[Key, Module]] = {True: {}, False: {}}  # translated ones, by ``contract``


class Compiled:
    """A kernel as machine code, called from Python as the kernel is.

    Arguments are passed by position, all of them: numbers, arrays of float64 or int64, tuples of
    these, and static objects: anything else, for which the kernel is compiled. Threads may call it
    at once; they do not hold the global interpreter lock.
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
            with _COMPILING:
                if types not in self._natives:  # another thread may have been quicker
                    self._natives[types] = _native((self.kernel, types), self._contract)
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
        TypeError: an array of other numbers, or of no dimension, or a number of another kind.
        OverflowError: an int of more than 64 bits.
    """
    if isinstance(argument, (bool, np.bool_)):
        words.append(bool(argument))
        return _BOOL
    if isinstance(argument, float):
        words.append(argument)
        return _FLOAT
    if isinstance(argument, (int, np.integer)):
        if not -(2**63) <= argument < 2**63:
            raise OverflowError(f"{argument}: kernels take integers of 64 bits")
        words.append(int(argument))
        return _INT
    if isinstance(argument, np.ndarray):
        try:
            kind = element_kind(argument)
        except SubsetError as error:
            raise TypeError(f"{error.problem}; {error.remedy}") from None
        words += argument.ctypes.data, argument.shape[0]
        lengths = (_INT, *argument.shape[1:])
        return Array("", kind, lengths, element_strides(argument), not argument.flags.writeable)
    if isinstance(argument, tuple):
        made_by = type(argument) if hasattr(argument, "_fields") else None
        return Group(made_by, tuple([flattened(each, words) for each in argument]))
    if isinstance(argument, (np.generic, complex)):
        raise TypeError(f"{argument!r}: kernels take float, int and bool; convert it")
    return Static(argument)


_BEYOND: list[str] = []  # told by CHECKED machine code, the first of each run at least


def _tell_beyond(where: bytes, index: int, length: int) -> None:
    if not _BEYOND:
        _BEYOND.append(f"{where.decode()}: the index {index} of {length} items")


_TELL = ctypes.CFUNCTYPE(None, ctypes.c_char_p, ctypes.c_int64, ctypes.c_int64)(_tell_beyond)
if CHECKED:
    machine_code.provide(BEYOND, _TELL)


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
        """Run the machine code and return its result.

        Raises:
            IndexError: ``CHECKED`` code met an index beyond its array.
        """
        self._call(packed, written)
        if _BEYOND:
            raise IndexError(_BEYOND.pop(0))
        return _rebuilt(self._result, iter(self._numbers.unpack(written)))


def _packing(types: tuple[Type, ...]) -> struct.Struct:
    return struct.Struct("".join(["=", *(_FORMATS[kind] for kind in leaf_kinds(*types))]))


def _rebuilt(type_: Type, numbers: Iterator[Any]) -> Any:
    """Return the value of Python whose numbers are given."""
    if isinstance(type_, Group):
        items = [_rebuilt(each, numbers) for each in type_.items]
        return type_.made_by(*items) if type_.made_by else tuple(items)
    if isinstance(type_, Static):
        return type_.object
    return bool(next(numbers)) if type_ == _BOOL else next(numbers)


# --- From a kernel to loaded machine code ---------------------------------------------------------


class _Stored(NamedTuple):
    """An object as the cache holds it.

    Attributes:
        name: of its function.
        header: ``parts``: names of the objects to be loaded before it, in order; ``result``: its
            type, pickled, if the object is found before its kernel is translated.
        code: the object.
    """

    name: str
    header: dict[str, Any]
    code: bytes


def _native(key: Key, contract: bool) -> _Native:
    name = name_of(key, is_entry=True, contract=contract)
    stored = None if name is None else _all_stored(name)
    if stored is None:
        try:
            module = Module(key, _PARTS[contract], is_entry=True, contract=contract)
        except KernelError as error:
            raise error.with_traceback(None) from None  # the compiler's own calls tell nothing
        except RecursionError:
            code = python_of(key[0]).__code__
            where = f"{code.co_filename}:{code.co_firstlineno}: in kernel {code.co_name!r}"
            raise KernelError(f"{where}: too deep an expression or call; split it") from None
        stored, result = _made(module), module.result
    else:
        result = pickle.loads(bytes.fromhex(stored[-1].header["result"]))  # noqa: S301 - from _made
    for each in stored:
        address = machine_code.load(each.name, each.code)
    return _Native(address, key[1], result)


def address_of(function: VectorFunction) -> int:
    """Return the address of the machine code of a function of vectors."""
    with _COMPILING:
        (stored,) = _all_stored(function.name) or _made(function)
        return machine_code.load(function.name, stored.code)


def _all_stored(name: str) -> list[_Stored] | None:
    """Return the stored objects of a function's parts and its own; None if one is missing."""
    found = cache.read(name)
    parts = [] if found is None else [(each, cache.read(each)) for each in found[0]["parts"]]
    if found is None or any(part is None for _, part in parts):
        return None
    return [_Stored(each, *part) for each, part in [*parts, (name, found)]]  # type: ignore[misc]


def _made(module: Module | VectorFunction) -> list[_Stored]:
    """Compile and store a module and its parts, but for those that are stored already."""
    modules = [*module.linked()]
    kept = {each.name: cache.read(each.name) for each in modules}
    missing = [each for each in modules if kept[each.name] is None]
    objects = machine_code.objects_of([(each.text(), each.is_vector) for each in missing])
    for each, code in zip(missing, objects, strict=True):
        header: dict[str, Any] = {"parts": [part.name for part in each.linked()][:-1]}
        if isinstance(each, Module) and each.lasting and each is module:
            header["result"] = pickle.dumps(each.result).hex()
        kept[each.name] = header, code
        cache.write(each.name, header, code)
    return [_Stored(each.name, *kept[each.name]) for each in modules]  # type: ignore[misc]
