"""Jobs in Slurm that belong to a folder, and why some ended; a script takes the place of squeue."""

from pathlib import Path

import pytest

from study.tracking import TrackingError
from study.tracking.slurm import refuse_held_jobs, slurm_reasons

LIMIT = (
    "slurmstepd-n1: error: *** JOB 5 ON n1 CANCELLED AT 2026-01-01T00:00:00 DUE TO TIME LIMIT ***"
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder from which jobs were submitted."""
    made = tmp_path / "study"
    (made / ".snakemake/slurm_logs").mkdir(parents=True)
    return made


@pytest.fixture
def answer(tmp_path, monkeypatch):
    """Replace squeue by a shell script, the only command on the PATH."""

    def answer(script: str) -> None:
        tools = tmp_path / "bin"
        tools.mkdir()
        (tools / "squeue").write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
        (tools / "squeue").chmod(0o755)
        monkeypatch.setenv("PATH", str(tools))

    return answer


def test_jobs_of_this_folder_are_held_and_of_no_other(folder, answer):
    lines = [
        f"7|{folder}|rule_chunk_wildcards_fig06_0",
        f"8|{folder.parent}|rule_chunk",  # of another folder
        f"9|{folder}|(null)",  # an allocation in which somebody works
        f"11_3|{folder}|rule_points",
    ]
    answer("\n".join(f"echo '{line}'" for line in lines))
    with pytest.raises(TrackingError, match=r"holds 2 jobs of this folder.* scancel 7 11_3"):
        refuse_held_jobs(folder)


def test_an_error_of_squeue_is_no_answer(folder, answer):
    answer("echo 'Unable to contact slurm controller' >&2; exit 1")
    with pytest.raises(TrackingError, match=r"squeue failed .Unable to contact slurm controller"):
        refuse_held_jobs(folder)
    refuse_held_jobs(folder.parent)  # which submitted nothing: it is not asked


def test_reasons_come_from_the_log_of_slurm(folder, monkeypatch):
    monkeypatch.chdir(folder)
    logs = folder / ".snakemake/slurm_logs"
    (logs / "5.log").write_text(
        f"WorkflowError:\nAt least one job failed.\n{LIMIT}\nsrun: error: n1: task 0: Terminated\n",
        encoding="utf-8",
    )
    (logs / "6.log").write_text(
        "Building DAG of jobs...\nModuleNotFoundError: No module named 'model'\n", encoding="utf-8"
    )
    said = "(check log file(s) for error details)"
    own = folder / "snakemake.log"
    own.write_text(
        f"    message: Error in group points\n    log: {logs}/5.log {said}\n    jobs:\n"
        f"        rule chunk:\n            log: results/logs/chunk/fig06/0.log {said}\n"
        f"        rule history:\n            log: results/logs/history/fig05.log {said}\n"
        f"Error in rule merge:\n    log: results/logs/merge/fig06.log {said}\n"
        f"Error in rule kernels:\n    log: results/logs/kernels.log, {logs}/6.log {said}\n"
        f"Error in rule precision:\n    log: results/logs/precision.log, {logs}/7.log {said}\n",
        encoding="utf-8",
    )
    reasons = slurm_reasons(Path("results"), str(own))
    assert reasons == {
        "chunk/fig06/0": f"Slurm job 5: {LIMIT}",
        "history/fig05": f"Slurm job 5: {LIMIT}",
        "kernels": "Slurm job 6: ModuleNotFoundError: No module named 'model'",
        "precision": "Slurm job 7: ended before it began; Slurm wrote no log",
    }
