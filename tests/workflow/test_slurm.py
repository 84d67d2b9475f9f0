"""The study as jobs of a real Slurm: it gives the bytes of a local build after any disturbance.

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
from tests.workflow.test_nothing_lost import failed_runs, outcomes

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.skipif(
        bool(missing()), reason=f"Slurm is not installed: no {', '.join(missing())}"
    ),
]
# Ask often; and no second attempt, unless a test is about it.
HASTY = ("--slurm-init-seconds-before-status-checks", "2", "--retries", "0")
ONE = "tiny/data/fig05.nc"
STALL = """ as metadata:
    if Path("stall").exists():  # at the first attempt
        Path("stall").unlink()
        __import__("time").sleep(600)
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
    run = made.snakemake(ONE)
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


def is_restarted(cluster: Any, built: Any, retries: int = 0) -> None:
    """`make` on Slurm succeeds with the bytes of the local build."""
    run = cluster.make(ONE, *HASTY, f"--retries={retries}")
    assert run.returncode == 0, run.stdout + run.stderr
    assert cluster.sha256(ONE) == built.sha256(ONE)


def test_jobs_of_a_killed_snakemake_that_still_wait_give_way_to_the_next(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    drain(slurm)
    process = compiled.start(ONE, *HASTY)
    held = wait_until(slurm.queued, "jobs wait in the queue")
    kill_snakemake(process)
    assert set(held) <= set(slurm.queued()), "they outlive Snakemake"
    process = compiled.start(ONE, *HASTY)
    wait_until(lambda: len(slurm.queued()) > len(held), "the next start has its own job")
    resume(slurm)
    assert process.wait(timeout=PATIENCE) == 0
    assert compiled.sha256(ONE) == built.sha256(ONE)
    assert outcomes(compiled)[-2:] == ["interrupted", "done"]
    wait_until(lambda: not slurm.queued(), "all jobs have ended")
    assert compiled.sha256(ONE) == built.sha256(ONE)


def test_a_cancelled_job_fails_its_start(compiled: Any, built: Any, slurm: Slurm) -> None:
    drain(slurm)
    process = compiled.start(ONE, *HASTY)
    (number,) = wait_until(slurm.queued, "a job waits in the queue")
    slurm.call("scancel", number)
    assert process.wait(timeout=PATIENCE) != 0
    resume(slurm)
    assert outcomes(compiled)[-1] == "failed"
    is_restarted(compiled, built)


def test_a_second_attempt_after_a_time_limit_has_more_time(
    compiled: Any, built: Any, slurm: Slurm
) -> None:
    job = compiled.folder / "workflow/scripts/sweep.py"
    job.write_text(job.read_text("utf-8").replace(" as metadata:\n", STALL), encoding="utf-8")
    rules = compiled.folder / "workflow/rules/figures.smk"
    text, limit = rules.read_text(encoding="utf-8"), "runtime=lambda wildcards, attempt: attempt"
    script = '    script:\n        "../scripts/sweep.py"'
    assert script in text
    text = text.replace(script, f"    resources:\n        {limit},\n{script}")
    rules.write_text(text, encoding="utf-8")
    (compiled.folder / "stall").touch()
    assert compiled.make(ONE, *HASTY).returncode != 0
    assert failed_runs(compiled)["sweep/fig05"]["status"] == "interrupted"
    (compiled.folder / "stall").touch()
    before = set(slurm.limits())
    is_restarted(compiled, built, retries=1)
    limits = {
        int(number): limit for number, limit in slurm.limits().items() if number not in before
    }
    assert [limit for _, limit in sorted(limits.items())] == ["1:00", "2:00"]
