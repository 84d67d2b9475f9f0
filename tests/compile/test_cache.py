"""The cache folder of the kernels."""

from pathlib import Path

import pytest

from model.compile import cache


@pytest.fixture
def source(tmp_path, monkeypatch):
    """The only file of a package with a cache of its own."""
    for layer in cache.KERNEL_LAYERS:
        assert (cache.PACKAGE / layer).is_dir()
        (tmp_path / layer).mkdir()
    path = tmp_path / "engines" / "scalar" / "step.py"
    path.parent.mkdir()
    path.write_text("x = 1\n", encoding="utf-8")
    monkeypatch.setattr(cache, "PACKAGE", tmp_path)
    monkeypatch.setenv("VIBRALIGN_CACHE", str(tmp_path / "kept"))
    return path


def test_changed_code_opens_another_folder_and_changed_words_do_not(source):
    def fingerprint(text):
        source.write_text(text)
        return cache.kernel_fingerprint()

    first = fingerprint('"""Words."""\nx = 1\n')
    assert fingerprint("x = 2\n") != first
    for words in ('"""Words."""\nx = 1\n', '"""Others."""\nx = 1\n', "# why\n\nx = (1)\n"):
        assert fingerprint(words) == first
    source.rename(source.with_name("stage.py"))
    assert cache.kernel_fingerprint() != first


@pytest.mark.usefixtures("source")
@pytest.mark.parametrize(
    ("variable", "below"), [("VIBRALIGN_CACHE", ""), ("XDG_CACHE_HOME", "vibralign")]
)
def test_the_folder_can_be_moved(tmp_path, monkeypatch, variable, below):
    monkeypatch.delenv("VIBRALIGN_CACHE", raising=False)
    monkeypatch.setenv(variable, str(tmp_path))
    expected = tmp_path / below / cache.kernel_fingerprint()
    assert cache.cache_folder() == expected
    assert expected.is_dir()


@pytest.mark.usefixtures("source")
def test_a_temporary_folder_replaces_one_that_cannot_be_created(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("VIBRALIGN_CACHE", str(blocked))
    monkeypatch.setattr(cache.tempfile, "gettempdir", lambda: str(tmp_path / "temp"))
    folder = cache.cache_folder()
    assert folder.is_dir()
    assert Path(tmp_path / "temp") in folder.parents


@pytest.mark.usefixtures("source")
@pytest.mark.parametrize("damage", [b"", b"0123", bytes(16), b"no name of files", b"\xff" * 16])
def test_a_damaged_name_of_the_folder_is_worked_out_again(tmp_path, damage):
    whole = cache.kernel_fingerprint()
    (kept,) = (tmp_path / "kept" / "fingerprints").iterdir()
    kept.write_bytes(damage)
    assert cache.kernel_fingerprint() == whole == kept.read_text(encoding="ascii")
