"""Make a folder ready for Snakemake after an interruption of the last run of the study.

``python workflow/settle.py snakemake OPTIONS...``. Two runs must not write the same files, and a
crash leaves a lock: Snakemake marks a run by files in .snakemake/locks, which stay after kill -9 or
a power cut. It then refuses to start until told --unlock, which would let both write if another run
were alive. Hence the order:

1. `make` holds a lock of its own, see hold.py. The rest is done here.
2. Refuse if a Snakemake that was started by hand is alive in this folder, on this machine or on
   another, or if Slurm still holds jobs of this folder.
3. Wait for jobs that outlived a killed Snakemake, since they still write.
4. A lock that is left now is a dead one: unlock. Half-written files are made again by
   rerun-incomplete in the profile.
5. Delete files that are not as their job left them, damaged or of another study: what is missing
   is made again.
"""

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil

from model.tracking.cluster import refuse_held_jobs
from model.tracking.history import history_folder, is_running
from model.tracking.records import TrackingError, discard_damaged


def alive(matches: Callable[[list[str]], bool]) -> Iterator[psutil.Process]:
    """Yield the processes in this folder whose command line matches, except this one's parents."""
    here, this = str(Path.cwd()), psutil.Process()
    family = {this.pid, *(parent.pid for parent in this.parents())}
    for process in psutil.process_iter():
        try:
            words = process.cmdline()
            if words and process.pid not in family and matches(words) and process.cwd() == here:
                yield process
        except psutil.Error:  # it has just ended, or is another user's
            continue


def is_snakemake(words: list[str]) -> bool:
    """Return whether a command line is Snakemake's."""
    return any(Path(word).name == "snakemake" for word in words[:3])


def is_job(words: list[str]) -> bool:
    """Return whether a command line is that of a job, of its shell, or submits one to Slurm."""
    runner = Path(words[0]).name.startswith(("python", "sh", "bash"))
    submits = Path(words[0]).name == "sbatch"
    return submits or (runner and any("workflow/run.py" in word for word in words[1:3]))


def main() -> None:
    """Do steps 2 to 5."""
    snakemakes = [str(process.pid) for process in alive(is_snakemake)]
    if snakemakes:
        sys.exit(f"Snakemake already runs in this directory, process {', '.join(snakemakes)}")
    roots = [history.parent for history in sorted(Path().glob("*/history"))]
    elsewhere = [lock.stem for root in roots for lock in history_folder(root).glob("*.lock")
                 if is_running(root, lock.stem)]  # fmt: skip
    if elsewhere:
        sys.exit(f"Snakemake runs in this directory on another machine, invocation {elsewhere[0]}")
    jobs = list(alive(is_job))
    if jobs:
        print("waiting for", len(jobs), "processes of an interrupted run to end", file=sys.stderr)
        psutil.wait_procs(jobs)
    try:
        refuse_held_jobs(Path.cwd())
    except TrackingError as held:
        sys.exit(str(held))
    locks = Path(".snakemake/locks")
    if locks.is_dir() and any(locks.iterdir()):
        subprocess.run([*sys.argv[1:], "--unlock"], check=True)
    for root in roots:
        for name in discard_damaged(root):
            print(f"{name}: not as its job left it, will be made anew", file=sys.stderr)


if __name__ == "__main__":
    main()
