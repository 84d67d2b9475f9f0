"""The study as jobs of a real Slurm: it gives the bytes of a local build after any disturbance.

`make slurm-test` runs this, on daemons of its own. Every test ends with a restart by `make`.
"""

import contextlib
import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import psutil
import pytest

from model.tracking.history import sidecars
from tests.workflow.slurm import Slurm, missing, running
from tests.workflow.test_nothing_lost import FEW, failed_runs, outcomes

pytestmark = [
    pytest.mark.slurm,
    pytest.mark.skipif(
        bool(missing()), reason=f"Slurm is not installed: no {', '.join(missing())}"
    ),
]
# Ask often; and no second attempt, unless a test is about it.
HASTY = ("--slurm-init-seconds-before-status-checks", "2", "--retries", "0")
ONE = "tiny/data/fig05.nc"
KERNELS = tuple(
    f"tiny/data/{name}.json" for name in ("kernels", "unlocated_kernels", "page_engines")
)
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


@pytest.fixture(scope="module")
def built(make_workspace: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A local build to compare with; tests must not change it."""
    made = make_workspace(tmp_path_factory.mktemp("built"))
    run = made.snakemake(*FEW)
    assert run.returncode == 0, run.stdout + run.stderr
    return made


@pytest.fixture
def cluster(slurm: Slurm, make_workspace: Any, tmp_path: Path) -> Iterator[Any]:
    """A workspace whose jobs run in Slurm; the queue is empty before and after."""
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
    """Wait until ``condition`` returns a true value, and return it."""
    until = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < until, f"waited in vain until {what}"
        time.sleep(0.5)
    return found


def drain(slurm: Slurm) -> None:
    """Drain the nodes, so that submitted jobs wait."""
    slurm.call("scontrol", "update", "nodename=n1,n2", "state=drain", "reason=test")


def resume(slurm: Slurm) -> None:
    """Resume the drained nodes, so that waiting jobs begin."""
    for line in slurm.call("sinfo", "--noheader", "--Node", "--format=%N %T").splitlines():
        node, state = line.split()
        if "drain" in state:
            slurm.call("scontrol", "update", f"nodename={node}", "state=resume")


def kill_snakemake(process: Any) -> None:
    """Kill (-9) all processes that `make` started here; jobs in Slurm go on."""
    for child in psutil.Process(process.pid).children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):
            child.kill()
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait(timeout=60)


def is_restarted(cluster: Any, built: Any, files: tuple[str, ...] = FEW, retries: int = 0) -> None:
    """`make` on Slurm succeeds with the bytes of the local build."""
    run = cluster.make(*files, *HASTY, f"--retries={retries}")
    assert run.returncode == 0, run.stdout + run.stderr
    assert cluster.sha256(*files) == built.sha256(*files)


def test_the_study_has_the_bytes_of_a_local_build_both_ways(
    make_workspace: Any, tmp_path: Path, slurm: Slurm, built_twice: dict[str, Any]
) -> None:
    """As jobs on two nodes, and by `make` with two cores in one allocation; after `make` itself.

    The nodes of this Slurm are one machine: an allocation of one may use the core of the other.
    """

    def build(made: Any, make: Callable[[], Any]) -> None:
        made.configure(built_twice)
        run = make()
        assert not run.returncode, run.stdout + run.stderr

    def in_allocation() -> Any:
        _, *variables = allocated.make_command()
        words = ["sbatch", "--wait", "--cpus-per-task=1", "--mem-per-cpu=6G", "--output=log"]
        script = f"{allocated.folder}/profiles/slurm/allocation.sbatch"
        return subprocess.run(
            [*words, f"--chdir={allocated.folder}", script, "CORES=2", *variables],
            env=allocated.environment,
            capture_output=True,
            text=True,
            check=False,
        )

    local, allocated, jobs = (
        make_workspace(tmp_path / name, profile, **slurm.environment)
        for name, profile in (("local", "default"), ("one", "default"), ("many", "slurm"))
    )
    build(local, lambda: local.make(*KERNELS))  # compiled once, for all three
    build(local, local.make)
    build(allocated, in_allocation)
    before = slurm.submitted()
    build(jobs, jobs.make)
    submitted, runs = slurm.submitted() - before, sidecars(jobs.folder / "tiny")
    assert 0 < submitted < len(runs) / 4, "jobs of seconds are grouped, and merging is local"
    assert "Nothing to be done" in jobs.make().stderr
    assert slurm.submitted() - before == submitted
    for made in (allocated, jobs):
        made.take_times(local)
        assert made.snakemake().returncode == 0, "`make` would measure the times again"
        assert made.results().items() ^ local.results().items() == set()


def test_a_killed_snakemake_leaves_jobs_that_make_does_not_start_twice(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    drain(slurm)
    process = compiled.start(*FEW, *HASTY)
    held = wait_until(slurm.queued, "jobs wait in the queue")
    kill_snakemake(process)
    assert set(held) <= set(slurm.queued()), "they outlive Snakemake"
    refused = compiled.make(*FEW, *HASTY)
    numbers = " ".join(sorted(slurm.queued(), key=int))
    assert refused.returncode != 0
    assert f"or end them with: scancel {numbers}" in refused.stderr
    compiled.added["SLURM_CONF"] = "/nowhere"
    assert "squeue failed" in compiled.make(*FEW, *HASTY).stderr, "no answer is not the answer none"
    compiled.added |= slurm.environment
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
    process = compiled.start(ONE, *HASTY)
    (number,) = wait_until(slurm.queued, "a job waits in the queue")
    slurm.call("scancel", number)
    assert process.wait(timeout=PATIENCE) != 0
    resume(slurm)
    assert failed_runs(compiled)["sweep/fig05"]["reason"] == (
        f"Slurm job {number}: ended before it began; Slurm wrote no log"
    )
    is_restarted(compiled, built, (ONE,))


def test_a_job_that_fails_before_its_command_says_why(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    drain(slurm)
    process = compiled.start(ONE, *HASTY)
    (number,) = wait_until(slurm.queued, "a job waits in the queue")
    tiny = compiled.folder / "config/tiny.yaml"
    text = tiny.read_text(encoding="utf-8")
    tiny.write_text(f"{text}\nstructure: {{inertia: -1.0}}\n", encoding="utf-8")
    resume(slurm)
    assert process.wait(timeout=PATIENCE) != 0
    reason = failed_runs(compiled)["sweep/fig05"]["reason"]
    assert reason.startswith(f"Slurm job {number}: ")
    assert "structure.inertia = -1.0: must be a finite number > 0" in reason
    tiny.write_text(text, encoding="utf-8")
    is_restarted(compiled, built, (ONE,))


@pytest.mark.parametrize("edited", ["code", "configuration"])
def test_a_job_does_not_run_what_was_edited_after_it_was_submitted(
    compiled: Any, built: Any, slurm: Slurm, edited: str
) -> None:
    drain(slurm)
    process = compiled.start(ONE, *HASTY)
    wait_until(slurm.queued, "a job waits in the queue")
    file = "workflow/scripts/sweep.py" if edited == "code" else "config/tiny.yaml"
    path = compiled.folder / file
    text = path.read_text(encoding="utf-8")
    added = "EDITED = True" if edited == "code" else "structure: {inertia: 6.0}"
    path.write_text(f"{text}\n{added}\n", encoding="utf-8")
    resume(slurm)
    assert process.wait(timeout=PATIENCE) != 0
    reason = failed_runs(compiled)["sweep/fig05"]["reason"]
    assert "refused: " in reason
    assert f"{edited} was edited after " in reason
    path.write_text(text, encoding="utf-8")
    is_restarted(compiled, built, (ONE,))


def test_a_job_over_its_time_limit_says_so_and_a_second_attempt_has_more(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    job = compiled.folder / "workflow/scripts/sweep.py"
    job.write_text(f"{job.read_text(encoding='utf-8')}\n{STALL}", encoding="utf-8")
    rules = compiled.folder / "workflow/rules/figures.smk"
    text, limit = rules.read_text(encoding="utf-8"), "runtime=lambda wildcards, attempt: attempt"
    script = '    script:\n        "../scripts/sweep.py"'
    assert script in text
    text = text.replace(script, f"    resources:\n        {limit},\n{script}")
    rules.write_text(text, encoding="utf-8")
    (compiled.folder / "stall").touch()
    assert compiled.make(ONE, *HASTY).returncode != 0
    reason = failed_runs(compiled)["sweep/fig05"]["reason"]
    assert reason.startswith("Slurm job ")
    assert reason.endswith("DUE TO TIME LIMIT ***")
    (compiled.folder / "stall").touch()
    before = set(slurm.limits())
    is_restarted(compiled, built, (ONE,), retries=1)
    limits = {
        int(number): limit for number, limit in slurm.limits().items() if number not in before
    }
    assert [limit for _, limit in sorted(limits.items())] == ["1:00", "2:00"]
