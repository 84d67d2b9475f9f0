"""The folder of compiled kernels."""

from pathlib import Path

import pytest

from model.physics import compiled


def test_a_changed_source_opens_another_folder(tmp_path, monkeypatch):
    for floor in ("physics", "solver", "runs"):
        (tmp_path / floor).mkdir()
    source = tmp_path / "solver" / "step.py"
    source.write_text("x = 1\n")
    monkeypatch.setattr(compiled, "_PACKAGE", tmp_path)
    first = compiled.kernel_fingerprint()
    source.write_text("x = 2\n")
    second = compiled.kernel_fingerprint()
    source.write_text("x = 1\n")
    assert first != second
    assert compiled.kernel_fingerprint() == first


@pytest.mark.parametrize(
    ("variable", "below"), [("VIBRALIGN_CACHE", ""), ("XDG_CACHE_HOME", "vibralign")]
)
def test_the_folder_can_be_moved(tmp_path, monkeypatch, variable, below):
    monkeypatch.delenv("VIBRALIGN_CACHE", raising=False)
    monkeypatch.setenv(variable, str(tmp_path))
    expected = tmp_path / below / compiled.kernel_fingerprint()
    assert compiled.cache_folder() == expected
    assert expected.is_dir()


def test_a_folder_that_cannot_be_made_gives_way_to_a_temporary_one(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("VIBRALIGN_CACHE", str(blocked))
    monkeypatch.setattr(compiled.tempfile, "gettempdir", lambda: str(tmp_path / "temp"))
    folder = compiled.cache_folder()
    assert folder.is_dir()
    assert Path(tmp_path / "temp") in folder.parents
