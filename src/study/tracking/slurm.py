"""Jobs in Slurm that belong to a folder: which are left, and why some ended.

Jobs run on other machines and outlive the Snakemake that submitted them. Snakemake's executor
starts jobs in the folder of the workflow, with a comment that begins with "rule_", and makes
.snakemake/slurm_logs for logs of failures. A folder without it has submitted no job.
"""

import re
import subprocess
import sys
from pathlib import Path

from study.tracking import TrackingError

_LOGS = Path(".snakemake/slurm_logs")
_QUESTION = ("squeue", "--noheader", "--format=%i|%Z|%k")  # number, folder, comment
_COMMENT = "rule_"
_LOG_LINE = re.compile(r" *log: (.*) \(check log file\(s\) for error details\)")
_ENDED = re.compile(r"error: \*\*\* JOB|oom.kill", re.IGNORECASE)  # by a limit or a cancellation
_RAISED = re.compile(r"\w*(Error|Exception)\b")
_PATIENCE = 60  # seconds: a busy controller answers late


def refuse_held_jobs(folder: Path) -> None:
    """Refuse to start a workflow in a folder while Slurm has jobs of it.

    Raises:
        TrackingError: Slurm has jobs of the folder; or jobs were submitted from it, and Slurm
            cannot be asked for them.
    """
    if not (folder / _LOGS).is_dir():
        return
    try:
        asked = subprocess.run(
            _QUESTION, capture_output=True, text=True, timeout=_PATIENCE, check=True
        )
    except FileNotFoundError:
        raise TrackingError(
            f"{folder}: jobs were submitted to Slurm from here, and there is no squeue to ask for "
            f"them: go where Slurm is, or if it has none of them any more, remove {_LOGS}"
        ) from None
    except subprocess.TimeoutExpired:
        raise TrackingError(f"squeue did not answer in {_PATIENCE} s: try again later") from None
    except subprocess.CalledProcessError as error:
        raise TrackingError(f"squeue failed ({error.stderr.strip()}): mend that first") from None
    jobs = (line.split("|", maxsplit=2) for line in asked.stdout.splitlines())
    here = str(folder.resolve())
    held = [number for number, place, comment in jobs
            if place == here and comment.startswith(_COMMENT)]  # fmt: skip
    if held:
        raise TrackingError(
            f"Slurm still holds {len(held)} jobs of this folder: wait until squeue shows none of "
            f"them, or end them with: scancel {' '.join(held)}"
        )


def slurm_reasons(root: Path, log: str | None) -> dict[str, str]:
    """Return the reasons of failed Slurm jobs, by name of the run.

    Snakemake's ``log`` names, for every failed job, Slurm's log and the logs of its runs. A time
    limit, a cancellation, and an error before a run's command began appear in Slurm's log only; a
    job that was cancelled before it began has none.
    """
    reasons: dict[str, str] = {}
    if log is None or not Path(log).is_file():
        return reasons
    reason, logs = None, root.absolute() / "logs"
    for line in Path(log).read_text(encoding="utf-8", errors="replace").splitlines():
        if line.startswith("Error in rule"):
            reason = None  # the next job may have run without Slurm
        named = _LOG_LINE.fullmatch(line)
        files = [Path(file) for file in named[1].split(", ")] if named else []
        for file in files:
            if _LOGS.name in file.parts:
                reason = f"Slurm job {file.stem}: {_last_error(file)}"
        for file in files:
            if reason and file.absolute().is_relative_to(logs):
                run = file.absolute().relative_to(logs).with_suffix("").as_posix()
                reasons.setdefault(run, reason)
    return reasons


def _last_error(log: Path) -> str:
    """Return the last error in Slurm's log of a job, in one line."""
    if not log.is_file():
        return "ended before it began; Slurm wrote no log"
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    ended = [line for line in lines if _ENDED.search(line)]
    if ended:
        return ended[-1].strip()
    first = next((i for i, line in enumerate(lines) if _RAISED.match(line)), len(lines) - 1)
    return " ".join(line.strip() for line in lines[first : first + 3]) or "its log is empty"


if __name__ == "__main__":
    try:
        refuse_held_jobs(Path.cwd())
    except TrackingError as held:
        sys.exit(str(held))
