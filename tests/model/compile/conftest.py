"""A cache of the kernels for one test, and a count of what is compiled."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from model.compile import cache, machine_code

Restart = Callable[[], None]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The base of a cache that has no machine code."""
    monkeypatch.setenv("VIBRALIGN_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(machine_code, "_LOADED", {})
    monkeypatch.setattr(cache, "_UNWRITTEN", {})
    cache.cache_folder.cache_clear()
    yield tmp_path / "cache"
    cache.cache_folder.cache_clear()


@pytest.fixture
def restart(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Restart:
    """Forget what is loaded, as in another process."""

    def forget() -> None:
        assert folder
        monkeypatch.setattr(machine_code, "_LOADED", {})
        monkeypatch.setattr(cache, "_UNWRITTEN", {})
        cache.cache_folder.cache_clear()

    return forget


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Texts of the modules that are compiled, as they are."""
    texts: list[str] = []
    compile_ = machine_code.object_of

    def counted(text: str, *rest: Any) -> bytes:
        texts.append(text)
        return compile_(text, *rest)

    monkeypatch.setattr(machine_code, "object_of", counted)
    return texts
