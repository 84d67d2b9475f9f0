"""Compile kernels with numba and keep their machine code on disk.

numba compiles every function to machine code of its own, optimised together with all that it calls,
and adds wrappers for calls from Python and C. Here a kernel is compiled to intermediate code once,
as a *part*. Machine code is made only of a *whole*: a kernel that Python calls, linked with its
parts. This cuts the compile time to a quarter (docs/decisions/0025-compiling.md).

Subclasses of numba's dispatcher, compiler, code library and cache do this. They override internals,
which any release of numba may change: hence the upper bound ``NUMBA_BELOW``, also in
pyproject.toml.
"""

import functools
import gc
import hashlib
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from llvmlite import ir

from model.compile.cache import PACKAGE, CheckedFiles, cache_folder

NUMBA_BELOW = (0, 69)
"""First release of numba (major, minor) with which these kernels are untested."""


def check_numba(version: str) -> None:
    """Refuse a numba whose internals may differ from those overridden here.

    Raises:
        ImportError: ``version`` is not below ``NUMBA_BELOW``.
    """
    release = tuple(int(part) for part in version.split(".")[:2])
    if release >= NUMBA_BELOW:
        bound = ".".join(map(str, NUMBA_BELOW))
        raise ImportError(
            f"numba {version} is installed, and vibralign needs numba < {bound}, because it "
            f"overrides internals of numba: pip install 'numba<{bound}'"
        )


check_numba(numba.__version__)

from numba.core.caching import (  # noqa: E402
    CompileResultCacheImpl,
    FunctionCache,
    _CacheLocator,
)
from numba.core.codegen import JITCodeLibrary, ll  # type: ignore[attr-defined]  # noqa: E402
from numba.core.registry import CPUDispatcher  # noqa: E402

from model.compile.passes import KernelCompiler  # noqa: E402

Function = TypeVar("Function", bound=Callable[..., Any])

_CACHE_FOLDER = str(cache_folder())
_FIRST_CALL = threading.Lock()  # of a kernel, which several threads may call at once
WITHOUT_WRAPPERS = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}  # options of a part
config: Any = numba.config  # its settings are set at import, unseen by type checkers

# --- Parts: kernels that other kernels call -----------------------------------------------------


class _Library(JITCodeLibrary):
    """Code of one kernel.

    Attributes:
        finished: modules that it calls and that are optimised already; see ``call_finished``.
    """

    def __init__(self, *named: Any) -> None:
        super().__init__(*named)
        self.finished: list[Any] = []


class _PartLibrary(_Library):
    """Intermediate code of a part; the parts that it calls are linked later, into a whole."""

    def finalize(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


def with_parts(libraries: list[Any]) -> list[Any]:
    """Return the libraries and, recursively, those that their parts link; each once.

    Callers come first, since LLVM's linker leaves out a function that nothing calls yet.
    """
    seen, ordered = set(), []

    def visit(library: Any) -> None:
        if library not in seen:
            seen.add(library)
            if isinstance(library, _PartLibrary):
                for each in library._linking_libraries:
                    visit(each)
            ordered.append(library)

    for each in libraries:
        visit(each)
    return ordered[::-1]


def call_finished(context: Any, builder: Any, name: str, code: str, arguments: list[Any]) -> None:
    """Write a call of the function ``name``, which ``code`` defines in LLVM's language.

    The code is vectorised and ordered already. Only one pass runs on it, which combines
    instructions, and it is linked after the whole has been optimised.
    """
    library = context.active_code_library
    module = ll.parse_assembly(f"{library.create_ir_module(name)}\n{code}")
    passes = ll.create_new_function_pass_manager()
    passes.add_instruction_combine_pass()
    for each in module.functions:
        passes.run(each, library.codegen._pass_builder())
    library.finished.append(module)
    signature = ir.FunctionType(ir.VoidType(), [each.type for each in arguments])
    function = ir.Function(builder.module, signature, name)
    function.attributes.add("nounwind")
    builder.call(function, arguments)


def link_finished(module: Any, libraries: list[Any]) -> None:
    """Link the ``finished`` modules of the libraries into their optimised ``module``."""
    for library in libraries:
        for each in getattr(library, "finished", ()):
            module.link_in(each, preserve=True)


class PartCompiler(KernelCompiler):
    """numba's compiler, up to the intermediate code, which it keeps in a ``library``."""

    library: type[JITCodeLibrary] = _PartLibrary

    def __init__(self, typing: Any, target: Any, _library: Any, *rest: Any) -> None:
        _args, _result, flags, *_ = rest
        flags.no_compile = True
        super().__init__(typing, target, self.library(target.codegen(), "part"), *rest)


class Symbol:
    """Operand that stands for a number where a kernel is traced instead of computed.

    A kernel called with a symbol among its arguments, also inside tuples, runs as Python code, so
    that the symbols record every operation.
    """

    def rule_of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function to trace in place of a kernel: by default its Python function."""
        return function


def _first_symbol(value: Any) -> Symbol | None:
    if isinstance(value, tuple):
        return next((found for each in value if (found := _first_symbol(each))), None)
    return value if isinstance(value, Symbol) else None


class _Part(CPUDispatcher):
    """A kernel as other kernels call it; calls from Python go to its ``_Whole``."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        super().__init__(
            function, targetoptions=options | WITHOUT_WRAPPERS, pipeline_class=PartCompiler
        )
        self._options = options
        self._whole: _Whole | None = None

    def typeof_pyval(self, value: Any) -> Any:
        """Return numba's type of an argument; for a symbol at once, since numba searches long."""
        if _first_symbol(value) is not None:
            return numba.types.pyobject
        return super().typeof_pyval(value)

    def _compile_for_args(self, *args: Any, **_named: Any) -> Any:
        symbol = _first_symbol(args)
        return self.whole() if symbol is None else symbol.rule_of(self.py_func)

    def whole(self) -> "_Whole":
        """Return the kernel as Python calls it."""
        if self._whole is None:
            with _FIRST_CALL:
                if self._whole is None:
                    whole: Any = _Whole(
                        self.py_func, targetoptions=self._options, pipeline_class=_WholeCompiler
                    )
                    whole.enable_caching()
                    self._whole = whole
        return self._whole

    def add_overload(self, cres: Any) -> None:
        key = object()  # in place of the address of machine code
        self.overloads[tuple(cres.signature.args)] = cres._replace(entry_point=key)
        self.targetctx.insert_user_function(key, cres.fndesc, [cres.library])

    def get_call_template(self, args: Any, kws: Any) -> Any:
        # One version for all constants; the optimiser folds them once the code is linked.
        plain = {name: numba.types.unliteral(each) for name, each in kws.items()}
        return super().get_call_template([numba.types.unliteral(each) for each in args], plain)


# --- Wholes: kernels that Python calls ----------------------------------------------------------


class _WholeLibrary(_Library):
    """Machine code for the widest vectors of the processor.

    LLVM prefers 256 bits on processors with 512, which may then run at a higher clock. The loops of
    the batch engine are arithmetic throughout, and gain more from the width.
    """

    def finalize(self) -> None:
        self._linking_libraries = with_parts(self._linking_libraries)
        super().finalize()

    def _optimize_final_module(self) -> None:
        codegen = self._codegen
        usual = codegen._tm
        codegen._tm = _wide_machine(codegen)
        try:
            super()._optimize_final_module()
        finally:
            codegen._tm = usual
        link_finished(self._final_module, [self, *self._linking_libraries])

    def serialize_using_object_code(self) -> Any:
        """Return what the cache stores: machine code, and the names of the functions in it.

        numba stores the whole intermediate code, from which it reads these names.
        """
        self._ensure_finalized()
        defined = [each.name for each in self._final_module.functions if not each.is_declaration]
        names = "\n".join(f'define void @"{name}"() {{ ret void }}' for name in defined)
        kept = self._get_compiled_object(), ll.parse_assembly(names).as_bitcode()
        return self.name, "object", kept


@functools.cache
def _wide_machine(codegen: Any) -> Any:
    """LLVM target machine of numba without its preference for vectors of 256 bits."""
    options: dict[str, Any] = {}
    codegen._customize_tm_options(options)
    if "+avx512f" not in options["features"]:  # another processor may not know the preference
        return codegen._tm
    options["features"] += ",-prefer-256-bit"
    target = ll.Target.from_triple(ll.get_process_triple())
    return target.create_target_machine(opt=config.OPT, **options)


class _WholeCompiler(KernelCompiler):
    """numba's compiler, into a ``_WholeLibrary``."""

    def __init__(self, typing: Any, target: Any, _library: Any, *rest: Any) -> None:
        library = _WholeLibrary(target.codegen(), "whole")
        library.enable_object_caching()
        super().__init__(typing, target, library, *rest)


class _Locator(_CacheLocator):
    """Place of a kernel's machine code in the cache.

    numba's own name a place by the path and the line of a function. By these, every checkout and
    every edit of a docstring would compile all kernels anew.
    """

    def __init__(self, file: Path) -> None:
        # The name of the cache folder stands for the contents of these.
        roots = (PACKAGE, Path(_CACHE_FOLDER).resolve())
        root = next((each for each in roots if file.is_relative_to(each)), None)
        self._place = str(file.relative_to(root)) if root else str(file)
        self._stamp = "" if root else hashlib.sha256(file.read_bytes()).hexdigest()

    @classmethod
    def from_function(cls, _function: Any, file: str) -> "_Locator":
        """Return the place of a function that ``file`` defines."""
        return cls(Path(file).resolve())

    def get_cache_path(self) -> str:
        """Return the cache folder."""
        return _CACHE_FOLDER

    def get_source_stamp(self) -> str:
        """Return a hash of the file, by which numba finds stored code out of date.

        Empty for files that the name of the cache folder stands for.
        """
        return self._stamp

    def get_disambiguator(self) -> str:
        """Return a hash of the place, since files in two folders may have the same name."""
        return hashlib.sha256(self._place.encode()).hexdigest()[:16]


class _StoredResult(CompileResultCacheImpl):
    """numba's conversion of a compiled kernel to what the cache stores, and back."""

    _locator_classes: list[type[object]] = [_Locator]  # noqa: RUF012  (as numba declares it)

    def reduce(self, cres: Any) -> Any:
        """Drop the environments that hold no constants: loading one imports its module."""
        *most, environments = super().reduce(cres)
        return *most, tuple(each for each in environments if each.consts)


class _Cache(FunctionCache):
    """numba's cache, read without setting up the compiler, from files with checksums.

    Before a look-up numba sets up everything it can compile, scipy's linear algebra included.
    Stored machine code needs none of it; after a miss, numba's compiler sets it up by itself.
    """

    _impl_class = _StoredResult

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = self._impl.locator.get_source_stamp()
        self._cache_file = CheckedFiles(self.cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class _Whole(CPUDispatcher):
    """A kernel as Python calls it: cached machine code with everything that it calls."""

    def enable_caching(self) -> None:
        self._cache = _Cache(self.py_func)

    def _compile_for_args(self, *args: Any, **named: Any) -> Any:
        collects = gc.isenabled()
        gc.disable()  # the collector would take a third of the time, and finds little garbage
        try:
            return super()._compile_for_args(*args, **named)  # type: ignore[misc]
        finally:
            if collects:
                gc.enable()


# --- Decorators ---------------------------------------------------------------------------------


def kernel(function: Function) -> Function:
    """Compile ``function`` at its first call: without Python objects or the GIL, cached on disk.

    A kernel creates no arrays and counts no references to them: its caller keeps them alive.
    Arithmetic is IEEE, but a product and a sum may become one operation (fused multiply-add).
    """
    return _compiled(function, forceinline=False)


def inlined_kernel(function: Function) -> Function:
    """Compile ``function`` into its callers: a call would copy some forty numbers."""
    return _compiled(function, forceinline=True)


def entry_point(function: Function) -> Function:
    """Return a kernel for frequent short calls from Python: each saves 1 µs, the symbol search."""
    called: Any = function.whole() if isinstance(function, _Part) else function
    return called


def python_of(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return the Python function of a kernel."""
    python: Callable[..., Any] = getattr(function, "py_func", function)
    return python


def options_of(forceinline: bool) -> dict[str, Any]:
    """Return numba's options of a kernel."""
    return {
        "nopython": True,
        "nogil": True,
        "error_model": "numpy",
        "fastmath": {"contract"},
        "_nrt": False,
        "forceinline": forceinline,
    }


def _compiled(function: Function, forceinline: bool) -> Function:
    if config.DISABLE_JIT:
        return function
    compiled: Any = _Part(function, options_of(forceinline))
    return compiled
