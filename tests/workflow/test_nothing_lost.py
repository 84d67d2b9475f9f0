"""Whatever happens to a build, `snakemake` afterwards gives the bytes of a clean one.

`make test` kills one build, `make nightly` others in four ways at VIBRALIGN_KILLS moments.
"""

import contextlib
import fcntl
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import psutil
import pytest
import xarray as xr

from model.sweeps.files import write_json
from model.sweeps.io import write_dataset
from study.tracking.history import load_history, load_runs
from study.tracking.records import file_hash

KILLS = int(os.environ.get("VIBRALIGN_KILLS", "50"))
VICTIMS = ("job", "snakemake", "group", "interrupt")
FEW = ("tiny/data/fig05.nc", "tiny/data/fig13.nc")  # of six jobs, chunks among them


def failed_runs(workspace: Any) -> dict[str, Any]:
    """Failed and interrupted runs by name."""
    found = load_runs(workspace.folder / "tiny")
    return {each["run"]: each for each in found if each["status"] != "done"}


def outcomes(workspace: Any) -> list[str]:
    """Outcomes of the starts in their order."""
    return [each["outcome"] for each in load_history(workspace.folder / "tiny")]


def is_clean(
    workspace: Any,
    built: Any,
    targets: Sequence[str] = FEW,
    *,
    cores: int = 2,
    own_python: bool = False,
) -> None:
    """`snakemake` succeeds with the bytes of a clean build, and leaves no temporary file."""
    build = workspace.snakemake if own_python else workspace.forked
    run = build(*targets, cores=cores)
    assert run.returncode == 0, run.stdout + run.stderr
    chunks = [f"tiny/data/chunks/fig13/{i}.nc" for i in range(3)]
    assert workspace.sha256(*targets, *chunks) == built.sha256(*targets, *chunks)
    assert not list((workspace.folder / "tiny").rglob("*.part"))
    again = workspace.dry_run(*targets)
    assert "Nothing to be done" in again.stdout + again.stderr


# --- Killed at random moments -------------------------------------------------------------------


def victims(process: subprocess.Popen[bytes], kind: str) -> list[int]:
    """Process ids to kill: the running jobs' Python, or Snakemake."""
    found, own = [], psutil.Process(process.pid)
    for child in (own, *own.children(recursive=True)):
        try:
            words = " ".join(child.cmdline())
        except psutil.Error:
            continue
        is_job = "/.snakemake/scripts/" in words and words.startswith(sys.executable)
        is_snakemake = "-m snakemake" in words
        if (kind == "job" and is_job) or (kind == "snakemake" and is_snakemake):
            found.append(child.pid)
    return found


def let_begin(process: subprocess.Popen[bytes], workspace: Any, jobs: int) -> None:
    """Wait until ``process`` has started this number of jobs, or has ended."""
    started = time.time()

    def begun() -> int:
        logs = (workspace.folder / "tiny/logs").glob("**/*.log")
        return sum(log.stat().st_mtime >= started for log in logs)

    while process.poll() is None and begun() < jobs:
        time.sleep(0.02)


def kill_when_there(process: subprocess.Popen[bytes], kind: str) -> None:
    """Kill (-9) the jobs or Snakemake as soon as one runs; do nothing if the build ends before."""
    while process.poll() is None:
        found = victims(process, kind)
        for pid in found:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        if found:
            return
        time.sleep(0.02)


def disturb(
    workspace: Any, targets: Sequence[str], kind: str, rng: np.random.Generator, most: int = 6
) -> bool:
    """Kill or interrupt a build before ``most`` jobs; return whether it ran until then."""
    process = workspace.start(*targets)
    let_begin(process, workspace, int(rng.integers(0, most)))
    time.sleep(float(rng.uniform(0.0, 1.0)))
    if process.poll() is not None:
        return False
    if kind == "group":
        workspace.kill(process)
    elif kind == "interrupt":  # as Ctrl-C does
        os.killpg(process.pid, signal.SIGINT)
    else:
        kill_when_there(process, kind)
    process.wait(timeout=3600)
    return True


def test_a_killed_build_ends_with_the_bytes_of_another(workspace: Any, built: Any) -> None:
    """It goes on in another order and on one core, in another folder.

    Snakemake alone is killed in ``test_jobs_that_outlive_a_killed_snakemake_are_waited_for``.
    """
    targets = [*built.PICTURES, *built.DATA]
    assert disturb(workspace, targets, "group", np.random.default_rng(0), most=2), "it ended before"
    is_clean(workspace, built, targets[::-1], cores=1)
    *before, last = outcomes(workspace)
    assert "running" not in before, "every start has an end"
    assert last == "done"


@pytest.mark.nightly
@pytest.mark.parametrize("trial", range(KILLS))
def test_a_killed_build_ends_with_the_bytes_of_a_clean_one(
    workspace: Any, built: Any, trial: int
) -> None:
    kind = VICTIMS[trial % len(VICTIMS)]
    targets = FEW if (trial + 1) % 5 else (*built.DATA, *built.BESIDE)
    rng, hits = np.random.default_rng(trial), 0
    for _ in range(int(rng.integers(1, 3))):  # once or twice, before anybody has mended it
        hits += disturb(workspace, targets, kind, rng)
    assert hits, "the build ended before it could be killed"
    is_clean(workspace, built, targets, own_python=True)
    assert "running" not in outcomes(workspace)[:-1], "every start has an end"
    print(f"{kind}: survived {hits} times")  # noqa: T201  (`pytest -rP` shows it)


# --- Two at a time -------------------------------------------------------------------------------


def test_a_second_snakemake_in_the_same_folder_is_refused(copy_of_built: Any) -> None:
    (copy_of_built.folder / "tiny/data/fig05.nc").unlink()
    with (copy_of_built.folder / "tiny/history/lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        listed = copy_of_built.dry_run(*FEW)
        assert listed.returncode == 0, "a dry run is allowed beside it"
        run = copy_of_built.forked(*FEW)
    assert run.returncode != 0
    assert "another start builds tiny now: wait until it ends, or stop it" in run.stderr
    assert not (copy_of_built.folder / "tiny/data/fig05.nc").exists()
    assert outcomes(copy_of_built)[-1] == "failed"


@pytest.mark.parametrize("option", ["--no-hooks", "--delete-all-output", "clean"])
def test_nothing_works_on_the_results_of_a_running_one(copy_of_built: Any, option: str) -> None:
    """Of Snakemake without hooks, Snakemake that deletes, and `make clean`."""
    (copy_of_built.folder / FEW[0]).unlink()
    with (copy_of_built.folder / "tiny/history/lock").open("w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if option == "clean":
            (copy_of_built.folder / "tiny").rename(copy_of_built.folder / "results-tiny")
            run = copy_of_built._run("make", f"PYTHON={sys.executable}", "clean")
        else:
            run = copy_of_built.forked(option, *FEW)
    assert run.returncode != 0
    assert "another start builds" in run.stderr
    if option == "clean":
        (copy_of_built.folder / "results-tiny").rename(copy_of_built.folder / "tiny")
    assert not (copy_of_built.folder / FEW[0]).exists()
    assert (copy_of_built.folder / FEW[1]).exists()


def test_a_list_changes_nothing(copy_of_built: Any) -> None:
    picture = copy_of_built.folder / "tiny/figures/fig11.svg"
    edited = picture.read_text(encoding="utf-8") + "<!-- note -->\n"
    picture.write_text(edited, encoding="utf-8")
    before = sorted(copy_of_built.folder.rglob("tiny/**/*"))
    for option in ("--list-rules", "--summary", "--dag", "--rulegraph", "--lint", "--unlock"):
        copy_of_built.forked("fig11", option)
    assert picture.read_text(encoding="utf-8") == edited
    assert sorted(copy_of_built.folder.rglob("tiny/**/*")) == before


def test_jobs_that_outlive_a_killed_snakemake_are_waited_for(
    copy_of_built: Any, built: Any
) -> None:
    workspace = copy_of_built
    (workspace.folder / FEW[0]).unlink()
    script = workspace.folder / "workflow/scripts/sweep.py"
    text = script.read_text(encoding="utf-8")
    stall = "\n    Path('begun').touch(); __import__('time').sleep(3.0); Path('ended').touch()\n"
    script.write_text(text.replace(" as metadata:\n", f" as metadata:{stall}"), encoding="utf-8")
    process = workspace.start(FEW[0])
    while not (workspace.folder / "begun").exists():
        assert process.poll() is None
        time.sleep(0.05)
    process.kill()
    process.wait(timeout=60)
    assert not (workspace.folder / "ended").exists()
    script.write_text(text, encoding="utf-8")
    run = workspace.forked(FEW[0])
    assert run.returncode == 0, run.stdout + run.stderr
    assert "waiting for jobs of an interrupted start to end" in run.stderr
    assert (workspace.folder / "ended").exists()
    assert workspace.sha256(FEW[0]) == built.sha256(FEW[0])


# --- A disk that is full ------------------------------------------------------------------------


def small_files() -> None:
    """Limit files to 30 kB: writing more fails, as on a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (30_000, 30_000))


@pytest.mark.nightly
def test_a_file_that_cannot_be_written_whole_is_not_taken_for_good(
    workspace: Any, built: Any
) -> None:
    for path in FEW:
        assert (built.folder / path).stat().st_size > 30_000
    run = workspace.snakemake(*FEW, preexec_fn=small_files)
    assert run.returncode != 0
    assert not any((workspace.folder / path).exists() for path in FEW)
    is_clean(workspace, built)


@pytest.mark.nightly
@pytest.mark.parametrize("kilobytes", [50, 150, 250, 350, 450])
def test_a_full_disk_loses_nothing(workspace: Any, built: Any, kilobytes: int) -> None:
    root = workspace.folder / "tiny"
    root.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(root)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small disk is not allowed here")
    try:
        run = workspace.snakemake(*built.DATA)
        assert run.returncode != 0
        told = run.stdout + run.stderr
        assert "No space left" in told or "was killed" in told
        shutil.copytree(root, workspace.folder / "kept")  # the same files, where there is room
    finally:
        subprocess.run(["umount", str(root)], check=True)
    root.rmdir()
    (workspace.folder / "kept").rename(root)
    is_clean(workspace, built)


# --- A file of another study --------------------------------------------------------------------


def test_a_foreign_chunk_fails_its_figure_only_and_says_why(copy_of_built: Any, built: Any) -> None:
    """Its record fits, so that only its content shows the error."""
    fig11, path = "tiny/data/fig11.nc", copy_of_built.folder / "tiny/data/chunks/fig13/1.nc"
    with xr.open_dataset(path) as stored:
        foreign = stored.load().assign_attrs(config_hash="0123456789abcdef")
    write_dataset(foreign, path)
    record = path.with_suffix(".run.json")
    stated = json.loads(record.read_text(encoding="utf-8"))
    write_json({**stated, "outputs": {path.name: file_hash(path)}}, record)
    (copy_of_built.folder / fig11).unlink()
    run = copy_of_built.forked("--keep-going", *FEW, fig11)
    assert run.returncode != 0
    reason = "1.nc: is not chunk 1 of fig13"
    last_lines = "\n".join((run.stdout + run.stderr).splitlines()[-12:])
    assert "merge/fig13 failed: " in last_lines
    assert reason in last_lines
    failed = failed_runs(copy_of_built)
    assert list(failed) == ["merge/fig13"]
    assert reason in failed["merge/fig13"]["reason"]
    assert outcomes(copy_of_built)[-1] == "failed"
    assert copy_of_built.sha256(fig11) == built.sha256(fig11), "the other figure is built"
    is_clean(copy_of_built, built)
    assert outcomes(copy_of_built)[-1] == "done"
