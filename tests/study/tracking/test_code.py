"""Hashes of code change with the code that runs."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from study.tracking import checkout, code
from study.tracking.code import code_of, import_closure

PROJECT = Path(__file__).resolve().parents[3]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the sources whose files a test may edit; the folder of ``model`` in it."""
    copy = tmp_path / "src"
    shutil.copytree(PROJECT / "src", copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(code, "_SOURCES", copy)
    (tmp_path / "requirements.lock").touch()
    return copy / "model"


def hashes(package: Path) -> dict[str, list[str]]:
    code._parsed.cache_clear()
    files = {"runs": "model/runs/align.py", "datasets": "model/sweeps/io.py"}
    files["style"] = "vibralign/plots/style.py"
    project = package.parents[1]
    return {name: code_of(project, f"src/{path}") for name, path in files.items()}


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_comments_layout_and_docstrings_change_nothing(package):
    before = hashes(package)
    forces = package / "physics" / "forces.py"
    edit(forces, "from model.physics.trig", "# a comment\n\n\nfrom model.physics.trig")
    edit(forces, "the pressing force, downward", "other words")
    assert hashes(package) == before


def test_an_edit_changes_what_depends_on_it_and_nothing_else(package):
    before = hashes(package)
    edit(package / "physics" / "forces.py", "return -p.press_force", "return -1.01 * p.press_force")
    after = hashes(package)
    for name in ("runs", "datasets"):
        changed = set(after[name]) ^ set(before[name])
        assert {each.split()[0] for each in changed} == {"model/physics/forces.py"}
    assert after["style"] == before["style"]


def test_what_is_kept_on_disk_is_what_is_found_anew(tmp_path, monkeypatch):
    source = PROJECT / "src/study/claims/claims.py"  # with a companion
    find = code._parsed.__wrapped__
    before = find(source)
    monkeypatch.setattr(code, "_outlines", lambda: tmp_path)
    assert find(source) == before
    assert len(list(tmp_path.iterdir())) == 1
    monkeypatch.setattr(code, "ast", None)  # it is not parsed again
    assert find(source) == before


def test_where_script_and_package_stand_changes_nothing(tmp_path, package):
    script = "workflow/scripts/plot.py"
    found = []
    for folder in (tmp_path / "a", tmp_path / "z"):  # before and after the package, by name
        (folder / script).parent.mkdir(parents=True)
        shutil.copy(PROJECT / script, folder / script)
        (folder / "requirements.lock").touch()
        found.append(code_of(folder, script))
    assert package.is_dir()
    assert found[0] == found[1]


def test_a_plotting_script_does_not_depend_on_the_integrator():
    closure = {path.name for path in import_closure(PROJECT / "workflow/scripts/schematic.py")}
    assert {"schematic.py", "fig04.py", "geometry.py"} <= closure
    assert not {"step.py", "series.py"} & closure


def test_a_computing_script_depends_on_all_that_it_computes_with():
    closure = {path.name for path in import_closure(PROJECT / "workflow/scripts/chunk.py")}
    assert {"forces.py", "contacts.py", "step.py", "series.py", "sweep.py"} <= closure
    assert not {"plots.py", "sheet.py", "page.py", "__main__.py"} & closure
    assert not {"study.py", "checks.py", "figures.py", "claims.py", "accuracy.py"} & closure


def test_what_records_a_job_and_what_only_types_need_is_no_code_of_it(tmp_path):
    files = [PROJECT / "workflow/scripts/chunk.py", PROJECT / "src/model/sweeps/sweep.py"]
    assert not [path for path in import_closure(*files) if path.parent.name == "tracking"]
    typed = tmp_path / "typed.py"
    typed.write_text(
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from study.config.study import Study\n"
        "else:\n    from model.sweeps.files import write_text\n"
    )
    assert {path.name for path in import_closure(typed)} == {"typed.py", "files.py"}


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
