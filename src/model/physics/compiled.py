"""How kernels are compiled, and where their machine code is kept.

numba's on-disk cache does not notice an edit in another file that a kernel calls. The cache folder
is therefore keyed by the content of every file that can hold a kernel: an edit anywhere among them
opens a fresh folder, and a stale kernel can never come back.
"""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.cgutils import get_null_value
from numba.extending import intrinsic, overload
from numba.np.arrayobj import make_array

Function = TypeVar("Function", bound=Callable[..., Any])

_PACKAGE = Path(__file__).resolve().parents[1]
_KERNEL_FLOORS = ("physics", "solver", "runs")


def kernel_fingerprint() -> str:
    """Hash of every source file that can hold a kernel (16 hexadecimal digits)."""
    digest = hashlib.sha256(numba.__version__.encode())
    for floor in _KERNEL_FLOORS:
        for source in sorted((_PACKAGE / floor).glob("*.py")):
            digest.update(source.name.encode())
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


@contextlib.contextmanager
def _numba_cache_in(folder: str) -> Iterator[None]:
    # numba reads the setting while it decorates, so other users of numba never see ours.
    previous = config.CACHE_DIR
    config.CACHE_DIR = folder
    try:
        yield
    finally:
        config.CACHE_DIR = previous


def kernel(function: Function) -> Function:
    """Compile ``function`` on first call: no Python objects, no GIL, cached.

    IEEE arithmetic, in which a product and a sum may be one operation (fused multiply-add).
    """
    return _compiled(function, forceinline=False)


def inlined_kernel(function: Function) -> Function:
    """A kernel that becomes part of its callers: a call would copy some forty numbers."""
    return _compiled(function, forceinline=True)


def _compiled(function: Function, forceinline: bool) -> Function:
    with _numba_cache_in(_CACHE_FOLDER):
        compiled: Any = numba.njit(
            cache=True,
            nogil=True,
            error_model="numpy",
            fastmath={"contract"},
            forceinline=forceinline,
        )(function)
    return compiled


def borrowed(array):
    """``array`` as a view that counts no references: whoever calls the kernel keeps it alive.

    Counting is an atomic operation each time an array is taken from a tuple or passed on; in a
    kernel of a few arithmetic operations it would cost more than they do.
    """
    return array


@intrinsic
def _uncounted(_context, array):
    def generate(context, builder, signature, arguments):
        view = make_array(signature.return_type)(context, builder, arguments[0])
        view.meminfo = get_null_value(view.meminfo.type)
        view.parent = get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), generate


@overload(borrowed)
def _borrowed_in_kernels(array):  # noqa: ARG001 - numba matches arguments by name
    return lambda array: _uncounted(array)  # type: ignore[call-arg]  # noqa: PLW0108
