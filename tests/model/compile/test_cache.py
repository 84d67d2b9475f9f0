"""The cache of the kernels: its folder, files that are damaged or cannot be written, edits."""

import errno
import os
import runpy
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from model.compile import cache
from model.compile.entries import compiled
from model.compile.identity import PACKAGE, digest_of
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


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only file of a package with a cache of its own."""
    for layer in cache.KERNEL_LAYERS:
        assert (PACKAGE / layer).is_dir()
        (tmp_path / layer).mkdir()
    path = tmp_path / "engine" / "scalar" / "step.py"
    path.parent.mkdir()
    path.write_text("x = 1\n", encoding="utf-8")
    monkeypatch.setattr(cache, "PACKAGE", tmp_path)
    return path


# -------------------------------------------------------------------------------------- the folder


@pytest.mark.usefixtures("folder")
def test_changed_code_opens_another_folder_and_changed_words_do_not(source: Path) -> None:
    def fingerprint(text: str) -> str:
        source.write_text(text)
        return cache.kernel_fingerprint()

    first = fingerprint('"""Words."""\nx = 1\n')
    assert fingerprint("x = 2\n") != first
    for words in ('"""Words."""\nx = 1\n', '"""Others."""\nx = 1\n', "# why\n\nx = (1)\n"):
        assert fingerprint(words) == first
    source.rename(source.with_name("stage.py"))
    assert cache.kernel_fingerprint() != first


@pytest.mark.usefixtures("folder", "source")
@pytest.mark.parametrize(
    ("variable", "below"), [("VIBRALIGN_CACHE", ""), ("XDG_CACHE_HOME", "vibralign")]
)
def test_the_folder_can_be_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, variable: str, below: str
) -> None:
    monkeypatch.delenv("VIBRALIGN_CACHE", raising=False)
    monkeypatch.setenv(variable, str(tmp_path))
    expected = tmp_path / below / cache.kernel_fingerprint()
    assert cache.cache_folder() == expected
    assert expected.is_dir()


@pytest.fixture
def temporary(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder for temporary files, where the cache's own cannot be made."""
    shutil.rmtree(folder)
    folder.write_text("")  # no folder
    (tmp_path / "temp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temp"))
    return tmp_path / "temp"


@pytest.mark.usefixtures("source")
def test_a_temporary_folder_replaces_one_that_cannot_be_created(temporary: Path) -> None:
    folder = cache.cache_folder()
    assert folder.is_dir()
    assert folder.parent == temporary / f"vibralign-{os.getuid()}"
    assert folder.parent.stat().st_mode & 0o777 == 0o700


@pytest.mark.usefixtures("source")
def test_machine_code_that_others_can_write_is_not_loaded(temporary: Path) -> None:
    laid = temporary / f"vibralign-{os.getuid()}"
    laid.mkdir()
    laid.chmod(0o777)
    assert cache.cache_folder().parent != laid


@pytest.mark.usefixtures("folder", "source")
@pytest.mark.parametrize("damage", [b"", b"0123", bytes(16), b"no name of files", b"\xff" * 16])
def test_a_damaged_name_of_the_folder_is_worked_out_again(folder: Path, damage: bytes) -> None:
    shutil.rmtree(folder / "fingerprints")
    whole = cache.kernel_fingerprint()
    (kept,) = (folder / "fingerprints").iterdir()
    kept.write_bytes(damage)
    assert cache.kernel_fingerprint() == whole == kept.read_text(encoding="ascii")


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


@pytest.mark.usefixtures("folder")
def test_a_part_is_compiled_once_for_two_entries(made: list[str]) -> None:
    module = load(PARTS)
    assert compiled(module.one)(8.0) == 5.0
    assert compiled(module.other)(8.0) == 3.0
    assert compiled(module.one)(6.0) == 4.0
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


def test_functions_of_one_place_differ_by_their_constants() -> None:
    functions = [lambda x: x + 1.0, lambda x: x + 2.0]
    for each in functions:
        each.__module__ = "model.physics.forces"
    assert len({digest_of(each) for each in functions}) == 2
