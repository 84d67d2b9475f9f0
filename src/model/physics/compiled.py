"""How kernels are compiled, and where their machine code is kept.

numba's on-disk cache does not notice an edit in another file that a kernel calls. The cache folder
is therefore keyed by the content of every file that can hold a kernel: an edit anywhere among them
opens a fresh folder, and a stale kernel can never come back.

numba gives every function machine code of its own, with that of all it calls, and wrappers for
calls from Python, which for some two hundred kernels took most of the time of compiling. Here a
kernel is compiled once as a part of others, and becomes machine code only with one that Python
calls (docs/decisions/0025-compiling.md).
"""

import contextlib
import functools
import gc
import hashlib
import os
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary, ll  # type: ignore[attr-defined]
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher

Function = TypeVar("Function", bound=Callable[..., Any])

_PACKAGE = Path(__file__).resolve().parents[1]
_KERNEL_FLOORS = ("physics", "events", "engines", "runs")


def kernel_fingerprint() -> str:
    """Hash of every source file that can hold a kernel (16 hexadecimal digits)."""
    digest = hashlib.sha256(numba.__version__.encode())
    for floor in _KERNEL_FLOORS:
        for source in sorted((_PACKAGE / floor).rglob("*.py")):
            digest.update(source.relative_to(_PACKAGE).as_posix().encode())
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of the compiled kernels; ``VIBRALIGN_CACHE`` or ``XDG_CACHE_HOME`` moves it."""
    base = os.environ.get("VIBRALIGN_CACHE")
    if base is None:
        home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        base = str(Path(home) / "vibralign")
    folder = Path(base) / kernel_fingerprint()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: compile into a folder of this user's own instead
        folder = Path(tempfile.gettempdir()) / f"vibralign-{os.getuid()}" / folder.name
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    return folder


_CACHE_FOLDER = str(cache_folder())
config: Any = numba.config  # its settings are set at import, unseen by type checkers
_ONE_AT_A_TIME = threading.Lock()


@contextlib.contextmanager
def _numba_cache_in(folder: str) -> Iterator[None]:
    # numba reads the setting while it decorates, so other users of numba never see ours.
    # Kernels are first called from several threads: one after the other, or the setting would stay.
    with _ONE_AT_A_TIME:
        previous = config.CACHE_DIR
        config.CACHE_DIR = folder
        try:
            yield
        finally:
            config.CACHE_DIR = previous


class _LinkedOnly(JITCodeLibrary):
    """Intermediate code that others link; what they make of it is optimised as a whole."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


class _PartCompiler(Compiler):
    """numba's compiler, up to the intermediate code."""

    def __init__(
        self, typingctx: Any, targetctx: Any, _library: Any, args: Any, return_type: Any,
        flags: Any, locals: Any,  # noqa: A002 - numba's name
    ) -> None:  # fmt: skip
        flags.no_compile = True
        library = _LinkedOnly(targetctx.codegen(), "part")
        super().__init__(typingctx, targetctx, library, args, return_type, flags, locals)


class _WideLibrary(JITCodeLibrary):
    """Machine code that uses the widest vectors there are.

    LLVM keeps to 256 bits on processors with 512, which may then run at a higher clock. In loops
    over lanes, which are arithmetic throughout, twice the width is worth more.
    """

    def _optimize_final_module(self) -> None:
        codegen = self._codegen
        usual = codegen._tm
        codegen._tm = _wide_machine(codegen)
        try:
            super()._optimize_final_module()
        finally:
            codegen._tm = usual

    def serialize_using_object_code(self) -> Any:
        """What the cache keeps: the machine code, and of the intermediate code no more than names.

        numba keeps all of it, for others to link, and from it learns what the machine code defines.
        """
        self._ensure_finalized()
        defined = [each.name for each in self._final_module.functions if not each.is_declaration]
        names = "\n".join(f'define void @"{name}"() {{ ret void }}' for name in defined)
        kept = self._get_compiled_object(), ll.parse_assembly(names).as_bitcode()
        return self.name, "object", kept


@functools.cache
def _wide_machine(codegen: Any) -> Any:
    """The target machine of numba's code generator without its preference for 256 bits."""
    options: dict[str, Any] = {}
    codegen._customize_tm_options(options)
    if "+avx512f" not in options["features"]:  # another processor may not know the preference
        return codegen._tm
    options["features"] += ",-prefer-256-bit"
    target = ll.Target.from_triple(ll.get_process_triple())
    return target.create_target_machine(opt=config.OPT, **options)


class _WholeCompiler(Compiler):
    """numba's compiler, into a ``_WideLibrary``."""

    def __init__(
        self, typingctx: Any, targetctx: Any, _library: Any, args: Any, return_type: Any,
        flags: Any, locals: Any,  # noqa: A002 - numba's name
    ) -> None:  # fmt: skip
        library = _WideLibrary(targetctx.codegen(), "whole")
        library.enable_object_caching()
        super().__init__(typingctx, targetctx, library, args, return_type, flags, locals)


class _KeptCode(CompileResultCacheImpl):
    """What the cache writes of a kernel."""

    def reduce(self, cres: Any) -> Any:
        """The kernel without the environments of its parts, which hold no constants to be read.

        To restore an environment, numba imports the module that it comes from.
        """
        *most, environments = super().reduce(cres)
        return *most, tuple(each for each in environments if each.consts)


class _Kept(FunctionCache):
    """numba's cache, from which a kernel comes without all that compiling needs.

    Before it looks into its cache, numba sets up everything that it can compile, scipy's linear
    algebra included. What it finds there is machine code, which asks for nothing; what it does not
    find is compiled, and then numba's compiler sets up everything.
    """

    _impl_class = _KeptCode

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class _Whole(CPUDispatcher):
    """A kernel as Python calls it: machine code with all that it calls, cached."""

    def enable_caching(self) -> None:
        self._cache = _Kept(self.py_func)

    def _compile_for_args(self, *args: Any, **named: Any) -> Any:
        collects = gc.isenabled()
        gc.disable()  # a third of the time goes to looking for garbage that is hardly there
        try:
            return super()._compile_for_args(*args, **named)  # type: ignore[misc]
        finally:
            if collects:
                gc.enable()


class Symbol:
    """What stands for a number where a kernel is to be read and not computed.

    A kernel called with one, also inside of tuples, runs as Python, so that the symbols see every
    operation of it.
    """

    def rule_of(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """What is called in place of a kernel: ``function``, that of the kernel, or another."""
        return function


def _first_symbol(value: Any) -> Symbol | None:
    if isinstance(value, tuple):
        return next((found for each in value if (found := _first_symbol(each))), None)
    return value if isinstance(value, Symbol) else None


class _Part(CPUDispatcher):
    """A kernel as other kernels call it; Python's calls go to its ``_Whole``."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        without_wrappers = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        super().__init__(
            function, targetoptions=options | without_wrappers, pipeline_class=_PartCompiler
        )
        self._options = options
        self._whole: _Whole | None = None

    def _compile_for_args(self, *args: Any, **_named: Any) -> Any:
        symbol = _first_symbol(args)
        if symbol is not None:
            return symbol.rule_of(self.py_func)
        if self._whole is None:
            with _numba_cache_in(_CACHE_FOLDER):
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
        # A constant argument is a number like others: not compiled anew, and folded all the same.
        plain = {name: numba.types.unliteral(each) for name, each in kws.items()}
        return super().get_call_template([numba.types.unliteral(each) for each in args], plain)


def kernel(function: Function) -> Function:
    """Compile ``function`` on first call: no Python objects, no GIL, cached.

    Kernels count no references to arrays, which would cost more than a few arithmetic operations:
    whoever calls one keeps its arrays alive, and a kernel makes none of its own.

    IEEE arithmetic, in which a product and a sum may be one operation (fused multiply-add).
    """
    return _compiled(function, forceinline=False)


def inlined_kernel(function: Function) -> Function:
    """A kernel that becomes part of its callers: a call would copy some forty numbers."""
    return _compiled(function, forceinline=True)


def _compiled(function: Function, forceinline: bool) -> Function:
    if config.DISABLE_JIT:
        return function
    options = {
        "nopython": True,
        "nogil": True,
        "error_model": "numpy",
        "fastmath": {"contract"},
        "_nrt": False,
        "forceinline": forceinline,
    }
    compiled: Any = _Part(function, options)
    return compiled
