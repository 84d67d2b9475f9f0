"""The wheel: it builds, holds the study's configuration, and imports away from the sources."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

from model.study.config import study_files, study_path

PROJECT = Path(__file__).resolve().parents[2]
NEEDED = ("pyproject.toml", "README.md", "LICENSE", "config", "src")


def test_a_wheel_runs_without_the_checkout(tmp_path: Path) -> None:
    source = tmp_path / "source"
    for name in NEEDED:
        path = PROJECT / name
        copy = shutil.copytree if path.is_dir() else shutil.copy
        source.mkdir(exist_ok=True)
        copy(path, source / name)
    build = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--quiet"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(source)], check=True)
    wheel = next(tmp_path.glob("*.whl"))
    with zipfile.ZipFile(wheel) as archive:
        for file in study_files(study_path()):
            assert f"model/study/config/{file.name}" in archive.namelist()
        assert "model/study/devices/new.yaml" in archive.namelist()
        archive.extractall(tmp_path / "installed")
    shutil.rmtree(source)
    code = (
        "import model; from model.study.config import baseline; "
        "print(model.__file__, baseline().clearance)"
    )
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
