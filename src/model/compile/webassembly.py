"""Compile kernels to WebAssembly, by numba and LLVM's own wasm32 target, without a linker.

The code generator of numba is set to wasm32 before anything is compiled: sizes of pointers and the
layout of structures are right from the first pass. From then on this process cannot run kernels:
``compile_modules`` belongs in a process of its own.

LLVM writes an object for a linker. One object alone is nearly a module: the addresses, indices and
types in it are valid as they stand, and only the list of exported functions is missing.

Internals of numba are replaced here: see ``NUMBA_BELOW`` in jit.py.
"""

import itertools
import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numba
from llvmlite import binding as ll
from numba.core import cgutils, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher, cpu_target
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from model.compile import jit

_TRIPLE = "wasm32-unknown-unknown"
_FEATURES = "+bulk-memory,+nontrapping-fptoint,+sign-ext,+mutable-globals,+simd128"
_STACK = 1 << 16  # bytes
_CUSTOM, _EXPORT, _START, _DATA = 0, 7, 8, 11  # sections of a module
NUMBERS = types.CPointer(types.float64)


class Function(NamedTuple):
    """A function to be exported: its name, its Python code, and the types of its arguments."""

    name: str
    python: Callable[..., None]
    arguments: tuple[Any, ...]


class Module(NamedTuple):
    """A WebAssembly module.

    It imports from "env" ``__linear_memory``, ``__stack_pointer`` and functions of the C library,
    and exports its one function.

    Attributes:
        binary: the bytes of the module.
        stack: byte at which its stack begins, which grows downwards; free memory follows.
    """

    binary: bytes
    stack: int


@intrinsic
def array_at(_context: Any, pointer: Any, offset: Any, shape: Any) -> Any:
    """Return the array of ``shape``, a tuple, that starts ``offset`` numbers after ``pointer``."""
    kind = types.Array(pointer.dtype, len(shape), "C")

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = make_array(kind)(context, builder)
        lengths = [
            context.cast(builder, each, of, types.intp)
            for each, of in zip(
                cgutils.unpack_tuple(builder, arguments[2]), signature.args[2], strict=True
            )
        ]
        strides = [context.get_constant(types.intp, 8)]
        for length in reversed(lengths[1:]):
            strides.insert(0, builder.mul(strides[0], length))
        place = context.cast(builder, arguments[1], signature.args[1], types.intp)
        data = builder.gep(builder.bitcast(arguments[0], array.data.type), [place])
        populate_array(array, data=data, shape=lengths, strides=strides, itemsize=strides[-1],
                       meminfo=None)  # fmt: skip
        return array._getvalue()

    return kind(pointer, offset, shape), generate


@intrinsic
def whole_numbers(_context: Any, pointer: Any) -> Any:
    """Return a pointer to numbers as a pointer to integers of eight bytes."""
    kind = types.CPointer(types.int64)

    def generate(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(kind))

    return kind(pointer), generate


def compile_modules(functions: list[Function]) -> Iterator[Module]:
    """Compile each function to a module; this process cannot run kernels from then on."""
    codegen, machine = _aim_at_webassembly()
    for each in functions:
        yield _module(_object(each, codegen, machine), each.name)


# --- numba, set to wasm32 -----------------------------------------------------------------------


class _Library(JITCodeLibrary):
    """Code that is not loaded into this process."""

    def _finalize_specific(self) -> None:
        pass

    def get_pointer_to_function(self, _name: str) -> int:
        """Return a number that is no address; numba uses it as a key."""
        self._ensure_finalized()
        return next(_KEYS)


class _Unoptimised(_Library):
    """Code of an exported function with all that it calls; ``_object`` optimises it."""

    def finalize(self) -> None:
        self._linking_libraries = jit.with_parts(self._linking_libraries)
        super().finalize()

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _Compiler(jit.PartCompiler):
    library = _Unoptimised


_KEYS = itertools.count(0x1000, 16)


def _aim_at_webassembly() -> tuple[Any, Any]:
    """Set numba's code generator to wasm32; return it and LLVM's target machine."""
    ll.initialize_all_targets()
    ll.initialize_all_asmprinters()
    target = ll.Target.from_triple(_TRIPLE)
    machine = target.create_target_machine(
        cpu="generic", features=_FEATURES, opt=3, reloc="static", codemodel="default"
    )
    context: Any = cpu_target.target_context
    context.refresh()  # before the switch: what it sets up for this machine is not used here
    codegen = context.codegen()
    codegen._tm, codegen._target_data = machine, machine.target_data
    codegen._data_layout = str(machine.target_data)
    usual = codegen._create_empty_module

    def empty_module(name: str) -> Any:
        module = usual(name)
        module.triple, module.data_layout = _TRIPLE, codegen._data_layout
        return module

    codegen._create_empty_module = empty_module
    codegen._add_module = codegen.set_env = lambda *_: None  # nothing is loaded into this process
    codegen._library_class = _Library
    context.__dict__.pop("target_data", None)
    # Kernels that are called while compiling, to write the series, run as Python.
    part: Any = jit._Part
    part._compile_for_args = lambda self, *args, **_: (
        symbol.rule_of(self.py_func) if (symbol := jit._first_symbol(args)) else self.py_func
    )
    return codegen, machine


def _object(function: Function, codegen: Any, machine: Any) -> bytes:
    """Compile one function to LLVM's object for a linker."""
    options = jit.options_of(forceinline=False) | jit.WITHOUT_WRAPPERS
    dispatcher: Any = CPUDispatcher(
        function.python, targetoptions=options, pipeline_class=_Compiler
    )
    dispatcher.add_overload = lambda _: None
    compiled_function = dispatcher._compiler.compile(function.arguments, numba.void)
    with global_compiler_lock:
        compiled_function.library.finalize()
    name = compiled_function.fndesc.llvm_func_name
    # The square root is an instruction, not a function of the C library.
    text = str(compiled_function.library._final_module)
    text = re.sub(r"declare [^\n]*@(sqrt|llvm\.sqrt\.f64)\([^\n]*\n", "", text)
    text = text.replace("@sqrt(", "@llvm.sqrt.f64(")
    module = ll.parse_assembly(f"{text}\ndeclare double @llvm.sqrt.f64(double)\n")
    for each in itertools.chain(module.functions, module.global_variables):
        if not each.is_declaration and each.name != name:
            each.linkage = "internal"  # so that unused functions are dropped
    module.get_function(name).name = function.name
    passes, builder = codegen._module_pass_manager()
    passes.run(module, builder)
    jit.link_finished(module, compiled_function.library._linking_libraries)
    written: bytes = machine.emit_object(module)
    return written


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


def _module(data: bytes, exported: str) -> Module:
    """Add the export to LLVM's object, and drop what only a linker reads."""
    sections = list(_sections(data))
    custom = (body for kind, body in sections if kind == _CUSTOM)
    symbols = next(_symbols(body) for body in custom if body[1:].startswith(b"linking"))
    name = exported.encode()
    export = _number(1) + _number(len(name)) + name + b"\0" + _number(symbols[name])
    kept = [(kind, body) for kind, body in sections if kind != _CUSTOM]
    place = next(n for n, (kind, _) in enumerate(kept) if kind >= _START)
    kept.insert(place, (_EXPORT, export))
    used = next((_end_of_data(body) for kind, body in kept if kind == _DATA), 0)
    stack = -(-(used + _STACK) // 64) * 64
    written = (bytes([kind]) + _number(len(body)) + body for kind, body in kept)
    return Module(data[:8] + b"".join(written), stack)


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
