"""The workflow with the real Snakemake, on a study small enough to build in seconds."""

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import yaml

PROJECT = Path(__file__).resolve().parents[2]
PARTS = ("Snakefile", "workflow", "config", "profiles", "requirements.lock")
TINY = {
    "results_root": "tiny",
    "figures": {
        **{f"fig{number:02}": {"swept": {"count": 4}, "chunks": 1} for number in range(6, 13)},
        "fig13": {"x": {"count": 4}, "y": {"count": 3}, "chunks": 3},
        "fig14": {"x": {"count": 4}, "y": {"count": 3}, "chunks": 1},
    },
    "accuracy": {
        "horizon": 30.0,
        "sets": 4,
        "chunks": 2,
        "settled": {"sets": 4, "chunks": 1, "longer": 2.0},
    },
    "precision": {
        "ladder": {
            "tolerances": [1e-3, 1e-6],
            "steps": [0.01],
            "max_evaluations": 20_000,
            "max_evaluations_scipy": 1_000,
        },
        "fixed_steps": {"figures": {"fig06": 2, "fig13": 2}},
    },
}
DATA = [
    "tiny/data/fig05.nc",
    "tiny/data/fig11.nc",
    "tiny/data/fig13.nc",
    "tiny/data/fixed_steps/fig13.nc",
    "tiny/data/precision.nc",
]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the workflow with the tiny study; the package is the installed one."""
    for part in PARTS:
        source = PROJECT / part
        if source.is_dir():
            shutil.copytree(source, tmp_path / part)
        else:
            shutil.copy(source, tmp_path / part)
    (tmp_path / "config" / "tiny.yaml").write_text(yaml.safe_dump(TINY), encoding="utf-8")
    return tmp_path


def command(*arguments: str) -> list[str]:
    study = ["--configfile", "config/tiny.yaml"]
    return [sys.executable, "-m", "snakemake", "-c2", *arguments, *study]


def snakemake(project: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments), cwd=project, capture_output=True, text=True, timeout=600, check=False
    )


def sha256(project: Path) -> dict[str, str]:
    return {path: hashlib.sha256((project / path).read_bytes()).hexdigest() for path in DATA}


def test_a_fault_in_the_configuration_stops_before_anything_is_made(project: Path) -> None:
    path = project / "config" / "tiny.yaml"
    path.write_text(yaml.safe_dump({**TINY, "structure": {"inertia": -1.0}}), encoding="utf-8")
    run = snakemake(project, "-n")
    assert run.returncode != 0
    assert "structure.inertia = -1.0: must be a finite number > 0" in run.stdout + run.stderr
    assert not (project / "tiny").exists()


def test_one_figure_is_a_target(project: Path) -> None:
    run = snakemake(project, "fig11", "-n")
    assert run.returncode == 0, run.stderr
    planned = run.stdout + run.stderr
    for rule in ("chunk", "merge", "plot", "fig11"):
        assert rule in planned
    for rule in ("report", "schematic", "fig12"):
        assert rule not in planned


def test_a_build_is_complete_and_a_second_has_nothing_to_do(project: Path) -> None:
    run = snakemake(project, *DATA)
    assert run.returncode == 0, run.stdout + run.stderr
    again = snakemake(project, *DATA, "-n")
    assert "Nothing to be done" in again.stdout + again.stderr
    # An edit below every job, the kernels' included, leaves none of them out.
    for script in (project / "workflow" / "scripts").glob("*.py"):
        script.write_text(
            script.read_text(encoding="utf-8") + "\nEDITED = True\n", encoding="utf-8"
        )
    (project / "tiny" / "data" / "fig05.nc").unlink()
    edited = snakemake(project, *DATA, "-n")
    counts = dict(line.split() for line in edited.stdout.splitlines() if len(line.split()) == 2)
    jobs = ("kernels", "chunk", "merge", "history", "unlocated_kernels", "fixed_steps", "precision")
    assert set(jobs) <= set(counts), edited.stdout
    assert int(counts["chunk"]) == 4


def test_a_caption_recomputes_no_trajectory(project: Path) -> None:
    assert snakemake(project, *DATA).returncode == 0
    study = {**TINY, "figures": {**TINY["figures"]}}
    study["figures"]["fig11"] = {**TINY["figures"]["fig11"], "title": "Another title"}
    (project / "config" / "tiny.yaml").write_text(yaml.safe_dump(study), encoding="utf-8")
    run = snakemake(project, *DATA, "-n")
    planned = run.stdout + run.stderr
    assert "merge" in planned
    assert "chunk " not in planned
    study["figures"]["fig11"]["held"] = {"press_force": 2.6}
    (project / "config" / "tiny.yaml").write_text(yaml.safe_dump(study), encoding="utf-8")
    changed = snakemake(project, *DATA, "-n")
    counts = dict(line.split() for line in changed.stdout.splitlines() if len(line.split()) == 2)
    assert counts["chunk"] == "1", "only fig11 computes anew"


def test_accuracy_prints_what_it_found_whether_or_not_it_computes(project: Path) -> None:
    run = snakemake(project, "accuracy")
    assert run.returncode == 0, run.stdout + run.stderr
    found = (project / "tiny" / "accuracy" / "summary.txt").read_text(encoding="utf-8")
    assert "error below tau_error" in found
    assert found in run.stdout
    again = snakemake(project, "accuracy")
    assert found in again.stdout
    assert "trying chunk" not in again.stdout + again.stderr


@pytest.fixture
def started(project: Path) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        command(*DATA),
        cwd=project,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    yield process
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)


@pytest.mark.parametrize("signal_sent", [signal.SIGKILL, signal.SIGINT])
def test_an_interrupted_build_ends_with_the_same_bytes(
    project: Path, started: subprocess.Popen[bytes], signal_sent: signal.Signals
) -> None:
    deadline = time.monotonic() + 120.0
    moment = np.random.default_rng(int(signal_sent)).uniform(0.0, 3.0)
    while not (project / "tiny" / "data" / "kernels.json").exists():
        assert time.monotonic() < deadline
        assert started.poll() is None, "it ended before it could be interrupted"
        time.sleep(0.02)
    time.sleep(moment)
    os.killpg(started.pid, signal_sent)
    started.wait(timeout=60)
    # The documented restart: `make` unlocks when no other run is alive, then runs again.
    if any(project.glob(".snakemake/locks/*")):
        assert snakemake(project, "--unlock").returncode == 0
    run = snakemake(project, *DATA)
    assert run.returncode == 0, run.stdout + run.stderr
    interrupted = sha256(project)
    shutil.rmtree(project / "tiny")
    assert snakemake(project, *DATA).returncode == 0
    assert sha256(project) == interrupted
