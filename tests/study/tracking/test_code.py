"""Hashes of code change with the code that runs."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from study.tracking import checkout, code
from study.tracking.code import code_of

PROJECT = Path(__file__).resolve().parents[3]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the sources whose files a test may edit; the folder of ``model`` in it."""
    copy = tmp_path / "src"
    shutil.copytree(PROJECT / "src", copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(code, "_SOURCES", copy)
    (tmp_path / "requirements.lock").touch()
    return copy / "model"


def test_what_is_kept_on_disk_is_what_is_found_anew(tmp_path, monkeypatch):
    source = PROJECT / "src/study/claims/claims.py"  # with a companion
    find = code._parsed.__wrapped__
    before = find(source)
    monkeypatch.setattr(code, "_outlines", lambda: tmp_path)
    assert find(source) == before
    assert len(list(tmp_path.iterdir())) == 1
    monkeypatch.setattr(code, "ast", None)  # it is not parsed again
    assert find(source) == before


def test_a_new_pin_changes_the_code_of_every_script(tmp_path):
    shutil.copytree(PROJECT / "workflow", tmp_path / "workflow")
    (tmp_path / "requirements.lock").write_text("numpy==1")
    before = code_of(tmp_path, "workflow/scripts/plot.py")
    (tmp_path / "requirements.lock").write_text("numpy==2")
    changed = set(code_of(tmp_path, "workflow/scripts/plot.py")) ^ set(before)
    assert {each.split()[0] for each in changed} == {"requirements.lock"}


def test_looking_at_the_checkout_takes_no_lock_in_it(package):
    """A killed job would leave git's lock behind, and git would then refuse to work there."""

    def git(*arguments: str) -> None:
        who = ["-c", "user.name=test", "-c", "user.email=test@localhost"]
        subprocess.run(
            ["git", *who, *arguments], cwd=package.parent, check=True, capture_output=True
        )

    git("init")
    git("add", ".")
    git("commit", "-m", "a package")
    for path in package.rglob("*.py"):
        os.utime(path, (1e9, 1e9))  # the index does not know these times: a status would refresh it
    index = package.parent / ".git" / "index"
    before = index.read_bytes()
    assert checkout.git_state(package)["dirty"] is False
    assert index.read_bytes() == before
    (package.parent / "results-smoke").symlink_to(package)  # results on another disk
    os.environ["GIT_DIR"] = str(package / "nowhere")  # as in a hook of another repository
    os.environ["GIT_TEST_ASSUME_DIFFERENT_OWNER"] = "1"  # git takes the checkout for another's
    try:
        assert checkout.git_state(package)["dirty"] is False
        (package / "edit.py").touch()
        assert checkout.git_state(package)["dirty"] is True
    finally:
        del os.environ["GIT_DIR"], os.environ["GIT_TEST_ASSUME_DIFFERENT_OWNER"]
