"""The study as jobs of a real Slurm: the bytes of a local build, whatever happens on the way.

`make slurm-test` runs this, on daemons of its own. Every test ends with a restart by `make`.
"""

import contextlib
import os
import signal
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from tests.workflow.slurm import Slurm, missing, running
from tests.workflow.test_nothing_lost import FEW, failed_runs, is_clean, outcomes

pytestmark = [
    pytest.mark.slurm,
    pytest.mark.skipif(
        bool(missing()), reason=f"Slurm is not installed: no {', '.join(missing())}"
    ),
]
# Ask often; and no second attempt, unless a test is about it.
HASTY = ("--slurm-init-seconds-before-status-checks", "2", "--retries", "0")
ONE = "tiny/data/fig05.nc"
RULES = "rules/figures.smk"
TRAJECTORY = 'message="{wildcards.figure}: computing the trajectory",'
STALL = """
import time
if Path("stall").exists():  # at the first attempt
    Path("stall").unlink()
    time.sleep(600)
"""
PATIENCE = 600.0


@pytest.fixture(scope="module")
def slurm() -> Iterator[Slurm]:
    # A short path: that of a socket may have a hundred characters.
    with tempfile.TemporaryDirectory(prefix="slurm") as here, running(Path(here)) as daemons:
        yield daemons


@pytest.fixture
def cluster(slurm: Slurm, make_workspace: Any, tmp_path: Path) -> Iterator[Any]:
    """A workspace whose jobs are Slurm's; the queue is empty before and after."""
    yield make_workspace(tmp_path / "project", "slurm", **slurm.environment)
    resume(slurm)
    slurm.empty()


@pytest.fixture
def compiled(cluster: Any) -> Any:
    """The same with compiled kernels, so that the next job is one that computes."""
    run = cluster.make("tiny/data/kernels.json", *HASTY)
    assert run.returncode == 0, run.stdout + run.stderr
    return cluster


def wait_until(condition: Callable[[], Any], what: str) -> Any:
    """Return what the condition returns as soon as it is true."""
    until = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < until, f"waited in vain until {what}"
        time.sleep(0.5)
    return found


def drain(slurm: Slurm) -> None:
    """Let what is submitted wait."""
    slurm.call("scontrol", "update", "nodename=n1,n2", "state=drain", "reason=test")


def resume(slurm: Slurm) -> None:
    """Let it begin; nodes that are not drained cannot be resumed."""
    if "drain" in slurm.call("sinfo", "--noheader", "--format=%T"):
        slurm.call("scontrol", "update", "nodename=n1,n2", "state=resume")


def kill_snakemake(process: Any) -> None:
    """Kill -9 of everything that `make` started on this machine; Slurm's jobs are not among it."""
    for child in psutil.Process(process.pid).children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            child.kill()
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=60)


def is_restarted(cluster: Any, built: Any, *targets: str, flags: tuple[str, ...] = HASTY) -> None:
    """`make` on Slurm ends well, with the bytes of the local build."""
    run = cluster.make(*(targets or FEW), *flags)
    assert run.returncode == 0, run.stdout + run.stderr
    files = targets or FEW
    assert cluster.sha256(*files) == built.sha256(*files)


def test_the_study_has_the_bytes_of_a_local_build(cluster: Any, built: Any, slurm: Slurm) -> None:
    targets = (*built.DATA, *built.BESIDE, *built.PICTURES)
    began, before = time.monotonic(), slurm.submitted()
    run = cluster.make(*targets, *HASTY)
    assert run.returncode == 0, run.stdout + run.stderr
    assert cluster.sha256(*targets) == built.sha256(*targets)
    jobs = slurm.submitted() - before
    runs = len(list((cluster.folder / "tiny").glob("data/**/*.run.json")))
    print(f"{runs} runs in {jobs} jobs of Slurm, {time.monotonic() - began:.0f} s")  # noqa: T201
    assert 0 < jobs < runs, "jobs that take seconds are grouped, and merging is local"
    again = cluster.make(*targets, *HASTY)
    assert "Nothing to be done" in again.stdout + again.stderr
    assert slurm.submitted() - before == jobs


def test_a_killed_snakemake_leaves_jobs_that_make_does_not_start_twice(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    drain(slurm)
    process = compiled.start_make(*FEW, *HASTY)
    held = wait_until(slurm.queued, "jobs wait in the queue")
    kill_snakemake(process)
    assert set(held) <= set(slurm.queued()), "they outlive Snakemake"
    refused = compiled.make(*FEW, *HASTY)
    numbers = " ".join(sorted(slurm.queued(), key=int))
    assert refused.returncode != 0
    assert f"or end them with: scancel {numbers}" in refused.stderr
    bare = compiled.snakemake("--unlock")
    assert bare.returncode == 0, bare.stderr
    bare = compiled.snakemake(*FEW)  # with the executor of this machine: it must not start either
    assert bare.returncode != 0
    assert f"scancel {numbers}" in bare.stdout + bare.stderr
    assert not (compiled.folder / ONE).exists()
    slurm.call("scancel", *numbers.split())
    resume(slurm)
    before = slurm.submitted()
    is_restarted(compiled, built)
    assert slurm.submitted() - before <= len(held) + 1
    assert "running" not in outcomes(compiled)


def test_cancelled_jobs_fail_with_the_reason(compiled: Any, built: Any, slurm: Slurm) -> None:
    drain(slurm)
    process = compiled.start_make(ONE, *HASTY)
    (number,) = wait_until(slurm.queued, "a job waits in the queue")
    slurm.call("scancel", number)
    assert process.wait(timeout=PATIENCE) != 0
    resume(slurm)
    assert failed_runs(compiled)["history/fig05"]["reason"] == (
        f"Slurm job {number}: ended before it began; Slurm wrote no log"
    )
    is_restarted(compiled, built, ONE)


def test_a_job_that_fails_before_its_command_says_why(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    drain(slurm)
    process = compiled.start_make(ONE, *HASTY)
    (number,) = wait_until(slurm.queued, "a job waits in the queue")
    tiny = compiled.folder / "config/tiny.yaml"
    text = tiny.read_text(encoding="utf-8")
    tiny.write_text(f"{text}\nstructure: {{inertia: -1.0}}\n", encoding="utf-8")
    resume(slurm)
    assert process.wait(timeout=PATIENCE) != 0
    reason = failed_runs(compiled)["history/fig05"]["reason"]
    assert reason.startswith(f"Slurm job {number}: ")
    assert "structure.inertia = -1.0: must be a finite number > 0" in reason
    tiny.write_text(text, encoding="utf-8")
    is_restarted(compiled, built, ONE)


@pytest.mark.parametrize("edited", ["code", "configuration"])
def test_a_job_does_not_run_what_was_edited_after_it_was_submitted(
    compiled: Any, built: Any, slurm: Slurm, edited: str
) -> None:
    drain(slurm)
    process = compiled.start_make(ONE, *HASTY)
    wait_until(slurm.queued, "a job waits in the queue")
    file = "workflow/jobs/history.py" if edited == "code" else "config/tiny.yaml"
    path = compiled.folder / file
    text = path.read_text(encoding="utf-8")
    added = "EDITED = True" if edited == "code" else "structure: {inertia: 6.0}"
    path.write_text(f"{text}\n{added}\n", encoding="utf-8")
    resume(slurm)
    assert process.wait(timeout=PATIENCE) != 0
    assert failed_runs(compiled)["history/fig05"]["reason"] == (
        f"job history refused: its {edited} was edited after it was submitted; start again"
    )
    path.write_text(text, encoding="utf-8")
    is_restarted(compiled, built, ONE)


def test_a_job_over_its_time_limit_says_so_and_a_second_attempt_has_more(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    job, rules = (compiled.folder / f"workflow/{name}" for name in ("jobs/history.py", RULES))
    job.write_text(f"{job.read_text(encoding='utf-8')}\n{STALL}", encoding="utf-8")
    text = rules.read_text(encoding="utf-8")
    rules.write_text(text.replace(TRAJECTORY, f"{TRAJECTORY} minutes=1,"), encoding="utf-8")
    (compiled.folder / "stall").touch()
    assert compiled.make(ONE, *HASTY).returncode != 0
    reason = failed_runs(compiled)["history/fig05"]["reason"]
    assert reason.startswith("Slurm job ")
    assert reason.endswith("DUE TO TIME LIMIT ***")
    (compiled.folder / "stall").touch()
    before = set(slurm.limits())
    is_restarted(compiled, built, ONE, flags=(*HASTY, "--retries", "1"))
    limits = {
        int(number): limit for number, limit in slurm.limits().items() if number not in before
    }
    assert [limit for _, limit in sorted(limits.items())] == ["1:00", "2:00"]


def test_one_allocation_builds_the_same(cluster: Any, built: Any, slurm: Slurm) -> None:
    script = cluster.folder / "profiles/slurm/allocation.sbatch"
    words = ["sbatch", "--parsable", "--cpus-per-task=1", "--mem-per-cpu=4G", "--wait"]
    _, *variables = cluster.make_command(*FEW)
    kept = [each for each in variables if not each.startswith("PROFILE=")]
    local = cluster.folder / ".venv"
    (cluster.folder / ".venv-slurm").rename(local)
    slurm.call(*words, f"--chdir={cluster.folder}", str(script), *kept, env=cluster.environment)
    assert cluster.sha256(*FEW) == built.sha256(*FEW)
    local.rename(cluster.folder / ".venv-slurm")
    is_clean(cluster, built)
