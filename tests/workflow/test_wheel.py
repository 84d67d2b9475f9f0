"""The distributions: built twice alike, shown on an index, and run away from the sources."""

import os
import re
import shutil
import subprocess
import sys
import zipfile
from email import message_from_bytes
from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]


def copy_of_checkout(folder: Path, umask: int) -> Path:
    """The files that git tracks, of today's date and with permissions by ``umask``."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=PROJECT, capture_output=True, check=True)
    before = os.umask(umask)
    for name in listed.stdout.decode().rstrip("\0").split("\0"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes((PROJECT / name).read_bytes())
    os.umask(before)
    return folder


def built(source: Path, into: Path, *options: str) -> dict[str, Path]:
    """Wheel and source distribution by suffix, built without a network."""
    command = [sys.executable, "-m", "hatchling", "build", "--directory", str(into), *options]
    subprocess.run(command, cwd=source, check=True, capture_output=True)
    return {path.suffix: path for path in into.iterdir()}


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("distributions")
    return built(copy_of_checkout(folder / "source", 0o022), folder / "dist")


def test_two_builds_have_the_same_bytes(distributions: dict[str, Path], tmp_path: Path) -> None:
    again = built(copy_of_checkout(tmp_path / "another", 0o077), tmp_path / "dist")
    assert set(again) == set(distributions) == {".whl", ".gz"}
    for suffix, path in distributions.items():
        assert again[suffix].name == path.name
        assert again[suffix].read_bytes() == path.read_bytes(), suffix
    unpack = [sys.executable, "-m", "tarfile", "--extract", str(distributions[".gz"]), tmp_path]
    subprocess.run(unpack, check=True)  # shutil knows no filter before Python 3.11.4
    (source,) = tmp_path.glob("vibralign-*")
    wheel = built(source, tmp_path / "from-sdist", "--target", "wheel")[".whl"]
    assert wheel.read_bytes() == distributions[".whl"].read_bytes()


def test_an_index_can_show_the_readme(distributions: dict[str, Path]) -> None:
    with zipfile.ZipFile(distributions[".whl"]) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith(".dist-info/METADATA"))
        metadata = message_from_bytes(archive.read(name))
    assert metadata["Description-Content-Type"] == "text/markdown"
    text = metadata.get_payload()
    assert text.startswith("# vibralign")
    assert "](docs/" in (PROJECT / "README.md").read_text(encoding="utf-8")
    targets = re.findall(r"\]\(([^)]*)\)", text)
    assert all(target.startswith("https://") for target in targets), targets


def test_a_wheel_runs_without_the_checkout(distributions: dict[str, Path], tmp_path: Path) -> None:
    with zipfile.ZipFile(distributions[".whl"]) as archive:
        packages = {name.partition("/")[0] for name in archive.namelist()}
        assert {name for name in packages if not name.endswith(".dist-info")} == {
            "model", "vibralign"
        }  # fmt: skip
        for name in ("vibralign/device/paper.yaml", "vibralign/device/new.yaml"):
            assert name in archive.namelist()
        archive.extractall(tmp_path / "installed")
    code = "import vibralign; print(vibralign.__file__, vibralign.baseline().clearance)"
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "installed")}
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    place, clearance = run.stdout.split()
    assert Path(place).is_relative_to(tmp_path / "installed")
    assert float(clearance) == 0.09


@pytest.mark.nightly
def test_an_empty_environment_with_the_wheel_assesses_a_device(
    distributions: dict[str, Path], tmp_path: Path
) -> None:
    """As an engineer installs it, from an index of packages."""
    python = tmp_path / "venv" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    pip = [python, "-m", "pip", "--disable-pip-version-check"]
    subprocess.run([*pip, "install", "--quiet", distributions[".whl"]], check=True)
    listed = subprocess.run([*pip, "freeze"], capture_output=True, text=True, check=True).stdout
    assert "vibralign" in listed
    assert "snakemake" not in listed
    shutil.copy(PROJECT / "docs" / "peg.yaml", tmp_path)
    own = {"PATH": "/usr/bin:/bin", "VIBRALIGN_CACHE": str(tmp_path / "cache")}
    command = [python.with_name("vibralign"), "assess", "--device", "peg.yaml"]
    command += ["--sheet", "peg.html"]
    run = subprocess.run(
        command, cwd=tmp_path, env=own, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert "reliable" in run.stdout
    assert (tmp_path / "peg.html").is_file()
