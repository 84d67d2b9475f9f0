"""The cache of the kernels: its folder, files that are damaged or cannot be written, edits."""

import errno
import os
import runpy
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from model.compile import cache
from model.compile.entries import compiled
from model.compile.identity import OutsideError, digest_of
from model.compile.source import KernelError
from model.physics.contacts import dot
from tests.model.compile.conftest import Restart
from tests.model.compile.sources import PRELUDE, load

PARTS = """\
@separate_kernel
def shared(x):
    return 0.5 * x


@kernel
def one(x):
    return shared(x) + 1.0


@kernel
def other(x):
    return shared(x) - 1.0
"""


# -------------------------------------------------------------------------------------- the folder


@pytest.mark.usefixtures("folder")
def test_another_compiler_or_target_opens_another_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    first = cache.compiler_fingerprint()
    monkeypatch.setattr(cache, "_COMPILER", cache._COMPILER + b"x = 2")
    second = cache.compiler_fingerprint()
    monkeypatch.setattr(cache, "written_for", lambda: "another processor")
    assert len({first, second, cache.compiler_fingerprint()}) == 3


@pytest.fixture
def temporary(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder for temporary files, where the cache's own cannot be made."""
    folder.write_text("")  # no folder
    (tmp_path / "temp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temp"))
    return tmp_path / "temp"


def test_a_temporary_folder_replaces_one_that_cannot_be_created(temporary: Path) -> None:
    folder = cache.cache_folder()
    assert folder.is_dir()
    assert folder.parent == temporary / f"vibralign-{os.getuid()}"
    assert folder.parent.stat().st_mode & 0o777 == 0o700


def test_machine_code_that_others_can_write_is_not_loaded(temporary: Path) -> None:
    laid = temporary / f"vibralign-{os.getuid()}"
    laid.mkdir()
    laid.chmod(0o777)
    assert cache.cache_folder().parent != laid


# ---------------------------------------------------------------------------------------- its files


def flipped(place: float) -> Callable[[bytes], bytes]:
    def flip(content: bytes) -> bytes:
        at = int(place * (len(content) - 1))
        return content[:at] + bytes([content[at] ^ 4]) + content[at + 1 :]

    return flip


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"",
    "three bytes": lambda content: content[:3],
    "no body": lambda content: content[:4],
    "cut in the header": lambda content: content[:20],
    "cut in the code": lambda content: content[: len(content) // 2],
    "cut at the end": lambda content: content[:-1],
    "longer": lambda content: content + b"\0",
    **{f"a bit at {place}": flipped(place) for place in (0.0, 0.001, 0.01, 0.1, 0.5, 0.9, 1.0)},
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_file_is_made_again(damage: str, restart: Restart, made: list[str]) -> None:
    compiled(dot)((1.0, 2.0, 3.0), 1.0, 10.0, 100.0)
    (path,) = cache.cache_folder().iterdir()
    whole = path.read_bytes()
    restart()
    path.write_bytes(DAMAGES[damage](whole))
    assert compiled(dot)((1.0, 2.0, 3.0), 1.0, 10.0, 100.0) == 321.0
    assert len(made) == 2
    assert path.read_bytes() == whole


@pytest.mark.parametrize("missing", ["shared", "one"])
def test_a_missing_or_damaged_part_is_made_again(
    missing: str, restart: Restart, made: list[str]
) -> None:
    module = load(PARTS)
    assert compiled(module.one)(8.0) == 5.0
    assert len(made) == 2
    (path,) = cache.cache_folder().glob(f"{missing}_*")
    restart()
    path.write_bytes(path.read_bytes()[:-1])
    assert compiled(module.one)(8.0) == 5.0
    assert len(made) == 3
    restart()
    assert compiled(module.one)(8.0) == 5.0
    assert len(made) == 3


@pytest.mark.parametrize("reason", [errno.EROFS, errno.ENOSPC, errno.EACCES])
def test_without_a_place_to_write_a_kernel_is_compiled_for_the_process(
    reason: int, restart: Restart, made: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write = Path.write_bytes

    def broken(path: Path, content: bytes) -> int:
        if reason == errno.ENOSPC:
            write(path, content[: len(content) // 2])  # as far as there is space
        raise OSError(reason, os.strerror(reason))

    module = load(PARTS)
    monkeypatch.setattr(Path, "write_bytes", broken)
    assert compiled(module.one)(8.0) == 5.0
    assert compiled(module.other)(8.0) == 3.0
    assert compiled(module.one)(8.0) == 5.0
    assert len(made) == 3, "the part and each entry once"
    assert [*cache.cache_folder().iterdir()] == []
    restart()
    monkeypatch.setattr(Path, "write_bytes", write)
    assert compiled(module.one)(8.0) == 5.0
    assert len(made) == 5
    assert len([*cache.cache_folder().iterdir()]) == 2


# -------------------------------------------------------------------------------------------- edits


def test_a_file_outside_of_the_package_may_be_edited(
    restart: Restart, made: list[str], tmp_path: Path
) -> None:
    """Whatever the edit: of the kernel, of a comment, or of a constant in another file."""
    kernels, constants = tmp_path / "kernels.py", tmp_path / "constants.py"

    def result(kernel: str, constant: str) -> float:
        reads = f'import runpy\n\nBY = runpy.run_path("{constants}")["BY"]\n\n\n'
        kernels.write_text(PRELUDE + reads + kernel)
        constants.write_text(constant)
        scaled: Callable[[float], float] = runpy.run_path(str(kernels))["scaled"]
        return compiled(scaled)(3.0)

    plain = "@kernel\ndef scaled(x):\n    return x * BY\n"
    assert result(plain, "BY = 2.0\n") == 6.0
    assert result(plain.replace("* BY", "- BY"), "BY = 2.0\n") == 1.0
    assert result(plain, "BY = 4.0\n") == 12.0
    assert len(made) == 3
    assert result("# why\n" + plain, "BY = 4.0  # why\n") == 12.0
    restart()
    assert result(plain, "BY = 2.0\n") == 6.0
    assert len(made) == 3


# ----------------------------------------------------------------------------- what names stand for

INSIDE = """\
import os

SCALE = float(os.environ["SCALE"])  # computed when the file is imported
TABLE = np.array([SCALE])


@separate_kernel
def shared(x):
    return SCALE * x + TABLE[0]


@kernel
def main(x):
    return shared(x) + 1.0
"""


@pytest.fixture
def inside(monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], Any]:
    """Import a text with a value of SCALE, as a module of the package."""

    def module(text: str, scale: str) -> Any:
        monkeypatch.setenv("SCALE", scale)
        loaded = load(text)
        for each in (loaded.shared, loaded.main):
            each.__module__ = "model.physics.made_for_a_test"
        return loaded

    return module


def test_two_values_of_a_computed_constant_share_no_object(
    inside: Callable[[str, str], Any], restart: Restart, made: list[str]
) -> None:
    for scale, expected in (("2.0", 9.0), ("4.0", 17.0), ("2.0", 9.0)):
        restart()
        assert compiled(inside(INSIDE, scale).main)(3.0) == expected
    assert len(made) == 4


def test_a_constant_that_changes_in_a_process_changes_names_too(
    inside: Callable[[str, str], Any], restart: Restart, made: list[str]
) -> None:
    restart()
    module = inside(INSIDE, "2.0")
    assert compiled(module.main)(3.0) == 9.0
    module.SCALE = 3.0
    assert compiled(module.main)(3.0) == 12.0
    module.TABLE[0] = 0.0
    assert compiled(module.main)(3.0) == 10.0
    module.SCALE, module.TABLE[0] = 2.0, 2.0
    assert compiled(module.main)(3.0) == 9.0
    assert len(made) == 6, "parts and entries of three states, the first from the cache"


def test_an_edit_since_the_import_is_refused_and_others_are_not_seen(
    inside: Callable[[str, str], Any], folder: Path
) -> None:
    text = INSIDE.replace("SCALE * x", "x / SCALE")
    module = inside(text, "2.0")
    file = Path(module.__file__)
    file.write_text(PRELUDE + text.replace("x / SCALE", "x - SCALE"))
    with pytest.raises(KernelError, match=r"'shared' has no source.*edited.*start Python again"):
        compiled(module.main)(3.0)
    assert not [*folder.rglob("*.o")], "nothing is kept for later processes"
    moved = text.replace("@separate", "# moved\n\n\n@separate").replace("+ 1.0", "+ 2.0 - 1.0")
    file.write_text(PRELUDE + moved)
    assert compiled(module.shared)(3.0) == 3.5


def test_functions_of_one_place_differ_by_their_constants() -> None:
    functions = [lambda x: x + 1.0, lambda x: x + 2.0]
    for each in functions:
        each.__module__ = "model.physics.forces"
    assert len({digest_of(each) for each in functions}) == 2


def test_functions_of_one_text_differ_by_what_they_hold_and_by_their_defaults() -> None:
    def scaled(by: float, plus: float) -> Any:
        def held(x: float, more: float = plus) -> float:
            return by * x + more

        held.__module__ = "model.physics.forces"
        return held

    made = [scaled(*each) for each in ((1.0, 0.0), (2.0, 0.0), (1.0, 1.0), (1.0, 0.0))]
    assert [digest_of(each) == digest_of(made[0]) for each in made] == [True, False, False, True]


def test_what_is_neither_data_nor_of_the_package_has_no_identity() -> None:
    class Stateful:
        value = 1.0

    for each in (Stateful(), lambda: 1.0):
        with pytest.raises(OutsideError):
            digest_of(each)
    assert digest_of(SimpleNamespace(a=1)) != digest_of(SimpleNamespace(a=2))
