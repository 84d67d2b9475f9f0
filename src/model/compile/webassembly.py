"""WebAssembly of an entry, by LLVM's wasm32 target, without a linker.

LLVM writes an object for a linker. One object alone is nearly a module: the addresses, indices and
types in it are valid as they stand, and only the list of exported functions is missing.
"""

from collections.abc import Iterator
from typing import NamedTuple

import llvmlite.binding as llvm

from model.compile.machine_code import optimised
from model.compile.module import Key, Module

_TRIPLE = "wasm32-unknown-unknown"
_FEATURES = "+bulk-memory,+nontrapping-fptoint,+sign-ext,+mutable-globals,+simd128"
_STACK = _PAGE = 1 << 16  # bytes
_CUSTOM, _IMPORT, _EXPORT = 0, 2, 7  # sections of a module


class WebAssembly(NamedTuple):
    """A WebAssembly module.

    It imports from "env" ``__linear_memory``, ``__stack_pointer`` and functions of the C library,
    and exports its entry as "run".

    Attributes:
        binary: the bytes of the module.
        stack: byte at which its stack begins, which grows downwards; free memory follows.
    """

    binary: bytes
    stack: int


def web_assembly_of(key: Key) -> WebAssembly:
    """Return an entry as WebAssembly: its kernel for arguments of these types, see entries.py."""
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple(_TRIPLE).create_target_machine(
        cpu="generic", features=_FEATURES, opt=3, reloc="static", codemodel="default"
    )
    context = llvm.create_context()
    module = llvm.parse_assembly("", context)
    *_, entry = parts = [*Module(key, None, is_entry=True).linked()]
    for each in parts:
        module.link_in(optimised(each.text(), machine, each.is_vector, context))
    defined = [each for each in module.functions if not each.is_declaration]
    for function in defined:
        function.linkage = "external" if function.name == entry.name else "internal"
    place = [each.name for each in defined].index(entry.name)
    return _linked(machine.emit_object(module), place)


# --- From LLVM's object to a module -------------------------------------------------------------


class _Bytes:
    """Reader of an object's numbers and names."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1]

    def number(self) -> int:
        """Return an unsigned number of 7 bits a byte (LEB128)."""
        found = shift = 0
        while True:
            byte = self.byte()
            found |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return found

    def text(self, length: int | None = None) -> bytes:
        length = self.number() if length is None else length
        self.at += length
        return self.data[self.at - length : self.at]


def _number(value: int) -> bytes:
    parts = [value & 127]
    while value := value >> 7:
        parts[-1] |= 128
        parts.append(value & 127)
    return bytes(parts)


def _sections(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield kind and content of each section after the header of eight bytes."""
    read = _Bytes(data)
    read.at = 8
    while read.at < len(data):
        kind = read.byte()
        yield kind, read.text()


def _linked(data: bytes, function: int) -> WebAssembly:
    """Add the export of a function to LLVM's object, and drop what only a linker reads."""
    sections = [(kind, body) for kind, body in _sections(data) if kind != _CUSTOM]
    imported, pages = _imports(dict(sections)[_IMPORT])
    place = next(n for n, (kind, _) in enumerate(sections) if kind > _EXPORT)
    sections.insert(place, (_EXPORT, b"\x01\x03run\0" + _number(imported + function)))
    written = (bytes([kind]) + _number(len(body)) + body for kind, body in sections)
    return WebAssembly(data[:8] + b"".join(written), pages * _PAGE + _STACK)


def _imports(body: bytes) -> tuple[int, int]:
    """Return how many functions are imported, and the pages of memory that hold the data."""
    read, functions, pages = _Bytes(body), 0, 0
    for _ in range(read.number()):
        read.text()  # module
        read.text()  # name
        kind = read.byte()
        if kind == 0:  # a function
            functions += 1
            read.number()
        elif kind == 3:  # a variable, and whether it changes
            read.text(2)
        else:  # memory, or a table after the kind of its elements
            read.text(1 if kind == 1 else 0)
            has_most, least = read.byte() & 1, read.number()
            pages = least if kind == 2 else pages
            if has_most:
                read.number()
    return functions, pages
