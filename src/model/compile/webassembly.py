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
_STACK = 1 << 16  # bytes
_CUSTOM, _EXPORT, _START, _DATA = 0, 7, 8, 11  # sections of a module


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
    *vectors, entry = Module(key, None, is_entry=True).linked()
    context = llvm.create_context()
    module = optimised(entry.text(), machine, is_finished=False, context=context)
    for each in vectors:
        module.link_in(optimised(each.text(), machine, is_finished=True, context=context))
    for each in module.functions:
        if not each.is_declaration and each.name != entry.name:
            each.linkage = "internal"
    return _linked(machine.emit_object(module), entry.name, "run")


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


def _linked(data: bytes, name: str, exported: str) -> WebAssembly:
    """Add the export to LLVM's object, and drop what only a linker reads."""
    sections = list(_sections(data))
    custom = (body for kind, body in sections if kind == _CUSTOM)
    symbols = next(_symbols(body) for body in custom if body[1:].startswith(b"linking"))
    label = exported.encode()
    export = _number(1) + _number(len(label)) + label + b"\0" + _number(symbols[name.encode()])
    kept = [(kind, body) for kind, body in sections if kind != _CUSTOM]
    place = next(n for n, (kind, _) in enumerate(kept) if kind >= _START)
    kept.insert(place, (_EXPORT, export))
    used = next((_end_of_data(body) for kind, body in kept if kind == _DATA), 0)
    stack = -(-(used + _STACK) // 64) * 64
    written = (bytes([kind]) + _number(len(body)) + body for kind, body in kept)
    return WebAssembly(data[:8] + b"".join(written), stack)


def _symbols(body: bytes) -> dict[bytes, int]:
    """Return the indices of the defined functions by name, from the section for the linker."""
    read, found = _Bytes(body), {}
    read.text()
    read.number()  # version
    while read.at < len(body):
        kind, size = read.byte(), read.number()
        end = read.at + size
        if kind == 8:  # the table of symbols
            for _ in range(read.number()):
                what, flags = read.byte(), read.number()
                undefined = flags & 0x10
                if what == 1:  # data
                    read.text()
                    if not undefined:
                        _ = read.number(), read.number(), read.number()
                elif what == 3:  # a section
                    read.number()
                else:
                    index = read.number()
                    named = read.text() if not undefined or flags & 0x40 else b""
                    if what == 0 and not undefined:
                        found[named] = index
        read.at = end
    return found


def _end_of_data(body: bytes) -> int:
    """Return the end of the last segment of the data section, in bytes."""
    read, end = _Bytes(body), 0
    for _ in range(read.number()):
        read.number()  # active, in memory 0
        read.byte()  # i32.const
        offset = read.number()
        read.byte()  # end
        end = max(end, offset + len(read.text()))
    return end
