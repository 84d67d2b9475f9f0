"""Machine code: LLVM optimises a module's text and writes an object, which is loaded.

Kernels may use the widest vectors of the processor. LLVM prefers 256 bits on processors with 512,
which may then run at a higher clock; the loops of the engine gain more from the width.

Run as a program, this file writes objects for another process: by llvmlite, only one thread of a
process compiles at a time.
"""

import contextlib
import ctypes
import functools
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import llvmlite.binding as llvm

_LOADED: dict[str, tuple[int, Any]] = {}  # address and owner of the machine code, by name
_LOADING = threading.Lock()


class Processor(NamedTuple):
    """The processor for which machine code is written, by LLVM's name and features."""

    name: str
    features: str


@functools.cache
def processor() -> Processor:
    """Return this processor, or the one that ``VIBRALIGN_CPU`` names, with its least features."""
    if name := os.environ.get("VIBRALIGN_CPU"):
        return Processor(name, "")
    features = str(llvm.get_host_cpu_features().flatten())
    # Another processor may not know the preference.
    wide = ",-prefer-256-bit" if "+avx512f" in features else ""
    return Processor(llvm.get_host_cpu_name(), features + wide)


# Registers of vectors, and how many floats each holds; a sum of eight floats uses the widest.
_REGISTERS = (("zmm", 8), ("ymm", 4), ("xmm", 2), (".2d", 2))
_SUM = """\
define <8 x double> @sum(<8 x double> %x) {
%y = fadd <8 x double> %x, %x
ret <8 x double> %y
}
"""


def floats_in_a_vector() -> int:
    """Return how many floats the widest vectors of the processor hold: 8, 4, 2 or 1."""
    module = llvm.parse_assembly(_SUM, llvm.create_context())
    assembly = _machine().emit_assembly(module)
    return next((count for register, count in _REGISTERS if register in assembly), 1)


def written_for() -> str:
    """Return what machine code depends on besides its text."""
    return f"LLVM {llvm.llvm_version_info}, {llvm.get_process_triple()}, {processor()}"


def _machine() -> Any:
    """Return LLVM's target machine of the processor; each thread needs one of its own."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    name, features = processor()
    return target.create_target_machine(cpu=name, features=features, opt=3, jit=True)


def object_of(text: str, is_finished: bool) -> bytes:
    """Return the object for a module's text, optimised unless it ``is_finished``.

    Finished code is vectorised and ordered already: only instructions are combined.
    """
    machine = _machine()
    module = optimised(text, machine, is_finished)
    written: bytes = machine.emit_object(module)
    return written


_SHORT = 200_000  # characters of LLVM's text that compile no slower than another process starts


def objects_of(modules: Sequence[tuple[str, bool]]) -> list[bytes]:
    """Return the object of each module, given by the arguments of ``object_of``.

    Long ones are shared with another process, the last ones first: these tend to take longest.
    """
    is_shared = len(modules) > 1 and sum(len(text) for text, _ in modules) > _SHORT
    if not is_shared or os.cpu_count() == 1:
        return [object_of(*each) for each in modules]
    waiting, objects = [*enumerate(modules)], dict[int, bytes]()

    def compile_by(compiler: Any) -> None:
        with contextlib.suppress(IndexError):
            while True:
                n, module = waiting.pop()
                objects[n] = compiler(*module)

    with _another_process() as compiler, ThreadPoolExecutor() as pool:
        there = pool.submit(compile_by, compiler)
        compile_by(object_of)
        there.result()
    return [objects[n] for n in range(len(modules))]


@contextlib.contextmanager
def _another_process() -> Iterator[Any]:
    """``object_of`` by another process; here, if no process can be started or it has ended."""
    command = [sys.executable, "-P", __file__]
    pipe = subprocess.PIPE
    try:
        process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)
    except OSError:
        yield object_of
        return

    def compiled_there(*module: Any) -> bytes:
        try:
            pickle.dump(module, process.stdin)  # type: ignore[arg-type]
            process.stdin.flush()  # type: ignore[union-attr]
            written: bytes = pickle.load(process.stdout)  # type: ignore[arg-type]  # noqa: S301
        except (OSError, EOFError, pickle.UnpicklingError):
            return object_of(*module)
        return written

    try:
        yield compiled_there
    finally:
        process.communicate()


def optimised(text: str, machine: Any, is_finished: bool, context: Any = None) -> Any:
    """Return LLVM's module for a text, optimised for a target machine."""
    module = llvm.parse_assembly(text, context or llvm.create_context())
    module.triple, module.data_layout = machine.triple, str(machine.target_data)
    options = llvm.create_pipeline_tuning_options(speed_level=3)
    options.loop_vectorization, options.slp_vectorization = True, False
    builder = llvm.create_pass_builder(machine, options)
    if is_finished:
        passes = llvm.create_new_function_pass_manager()
        passes.add_instruction_combine_pass()
        for each in module.functions:
            passes.run(each, builder)
    else:
        builder.getModulePassManager().run(module, builder)
    return module


def provide(name: str, function: Any) -> None:
    """Make a function of ctypes one that machine code may call by this name."""
    llvm.add_symbol(name, ctypes.cast(function, ctypes.c_void_p).value)


def load(name: str, machine_code: bytes) -> int:
    """Load an object and return the address of its function ``name``, which others may then call.

    What it calls in other objects must have been loaded before.
    """
    with _LOADING:
        if name not in _LOADED:
            machine = _machine()
            engine = llvm.create_mcjit_compiler(
                llvm.parse_assembly("", llvm.create_context()), machine
            )  # fmt: skip
            engine.add_object_file(llvm.ObjectFileRef.from_data(machine_code))
            engine.finalize_object()
            address = engine.get_function_address(name)
            llvm.add_symbol(name, address)
            _LOADED[name] = address, engine
        return _LOADED[name][0]


if __name__ == "__main__":
    with contextlib.suppress(EOFError):
        while True:
            written = object_of(*pickle.load(sys.stdin.buffer))  # noqa: S301 - from compiled_there
            pickle.dump(written, sys.stdout.buffer)
            sys.stdout.flush()
