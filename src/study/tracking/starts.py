"""Starts of the study: what each call of Snakemake does before, between and after its jobs.

The Snakefile calls ``begin``. A start that executes jobs locks the results root, records itself,
looks at the results on which it would build, and records its end. It follows Snakemake by the
events that Snakemake logs in its main process; no option of Snakemake leaves these out. A job
refuses to run without a start.
"""

import atexit
import json
import logging
import os
import platform
import shlex
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from snakemake.common import NOTHING_TO_BE_DONE_MSG
from snakemake.exceptions import WorkflowError
from snakemake.logging import LogEvent, logger

from model.sweeps.files import write_json
from study.tracking import TrackingError
from study.tracking.checkout import git_state, versions
from study.tracking.code import code_hash, code_of
from study.tracking.history import free_number, load_start, start_file
from study.tracking.locks import hold_as_job, lock_root, say, tell
from study.tracking.records import START, Record, iso, look, stated_hash


class Start(logging.Filter):
    """One start, in Snakemake's main process."""

    def __init__(self, workflow: Any, root: Path) -> None:
        super().__init__()
        self.study: Record = {}  # the configuration, set when it is known
        self._workflow, self._shown = workflow, root
        self._root = root.absolute()  # Snakemake goes back to another folder before it ends
        self._began = datetime.now(UTC)
        self._record: Record = {}
        self._outcome, self._error, self._looked = "interrupted", "", False
        logger.addFilter(self)
        atexit.register(self._end)

    def filter(self, record: logging.LogRecord) -> bool:
        """Follow Snakemake, which calls this at once; what is raised here stops it."""
        event, message = getattr(record, "event", None), record.getMessage()
        if event == LogEvent.ERROR:
            lines = (line.strip() for line in message.splitlines())
            self._outcome, self._error = "failed", "; ".join(filter(None, lines))
        elif self._workflow.output_settings.dryrun:
            pass
        elif event == LogEvent.WORKFLOW_STARTED:
            _refusing(self._begin)
        elif event == LogEvent.RUN_INFO or message == NOTHING_TO_BE_DONE_MSG:
            _refusing(self._look)
        return True

    def _begin(self) -> None:
        """Lock the results root and record the start, before Snakemake looks at its files."""
        lock = lock_root(self._shown)
        for part in self._root.rglob(".*.part"):  # of killed jobs
            part.unlink()
        self._write_start()
        tell(lock, self._record["start"])
        scripts = Path(self._workflow.basedir, "workflow/scripts").glob("*.py")
        told = {name: self._record[name] for name in ("start", "versions", "git")}
        told["codes"] = {each.stem: self._code(f"workflow/scripts/{each.name}") for each in scripts}
        os.environ[START] = json.dumps(told | {"study": stated_hash(self.study)})

    def _write_start(self) -> None:
        """Write the record of a start that goes on."""
        self._record = {
            "start": free_number(self._root),
            "outcome": "running",
            "started": iso(self._began),
            "command": [Path(sys.argv[0]).name, *sys.argv[1:]],
            "host": platform.node(),
            "versions": versions(),
            "git": git_state(),
            "study": self.study,
        }
        write_json(self._record, start_file(self._root, self._record["start"]))

    def _code(self, source: str) -> str:
        return code_hash(code_of(Path(self._workflow.basedir), source))

    def _look(self) -> None:
        """Look at the outputs of all jobs that Snakemake leaves out, before it runs the others."""
        dag, touches = self._workflow.dag, self._workflow.touch
        kept = (job for job in dag.jobs if touches or not dag.needrun(job))
        look(job for job in kept if hasattr(job.output, "record"))
        self._looked = True

    def _end(self) -> None:
        """Record the end, and tell which runs failed; the process ends then."""
        logger.removeFilter(self)
        if self._looked and not self._error and not [*self._workflow.dag.needrun_jobs()]:
            self._outcome = "done"  # every job has finished
        if not self._record and (
            self._outcome != "failed" or self._workflow.output_settings.dryrun
        ):
            return
        try:
            if not self._record:  # refused before it executed anything
                (self._root / "history").mkdir(parents=True, exist_ok=True)
                self._write_start()
            logs, now = self._workflow.logger_manager.get_logfile(), datetime.now(UTC)
            self._record |= {
                "outcome": self._outcome,
                "ended": iso(now),
                "wall_seconds": round((now - self._began).total_seconds(), 3),
                "snakemake_log": logs[0] if logs else None,
                "reason": self._error,
            }
            number = self._record["start"]
            write_json(self._record, start_file(self._root, number))
            failures = load_start(self._root, number)["failures"]
        except (OSError, TrackingError) as error:
            say(f"the end of this start could not be recorded: {error}")
            return
        for each in failures:
            log = self._shown / f"logs/{each['run']}.log"
            say(f"{each['run']} {each['status']}: {each['reason']} ({log})")


def _refusing(step: Callable[[], object]) -> None:
    """Take a step of a start; what goes wrong stops Snakemake, in words."""
    try:
        step()
    except (OSError, TrackingError) as error:
        raise WorkflowError(str(error)) from None


def refuse_module(workflow: Any) -> None:
    """Refuse a Snakefile that includes the study's, or takes it as a module.

    Raises:
        WorkflowError: it does.
    """
    if len(workflow.included_stack) > 1:
        raise WorkflowError(
            "vibralign's study is no module: its Snakefile builds in its own checkout only; clone "
            "the repository, and run `snakemake` there"
        )


def begin(workflow: Any, root: Path) -> Start | None:
    """Begin a start of the study that builds into ``root``; return None in a job on a cluster.

    Raises:
        WorkflowError: results are to be deleted while another start builds them; or the start of
            this job was killed, and another builds here.
    """
    if shlex.quote(sys.executable) != sys.executable:  # Snakemake's shell commands set no quotes
        interpreter = Path(sys.executable)
        os.environ["PATH"] = f"{interpreter.parent}{os.pathsep}{os.environ['PATH']}"
        sys.executable = interpreter.name
    os.environ["MPLBACKEND"] = "agg"  # that of a notebook draws no files
    if not workflow.is_main_process:
        _refusing(lambda: hold_as_job(root, json.loads(os.environ[START])["start"]))
        return None
    if any(word.startswith("--delete-") for word in sys.argv):  # Snakemake logs no event of these
        _refusing(lambda: lock_root(root))
    return Start(workflow, root)


def configure(start: Start | None, study: Record) -> None:
    """Tell a start the configuration, or compare it with that of the start of this job.

    Raises:
        WorkflowError: the configuration was edited after the job was submitted.
    """
    if start is not None:
        start.study = study
    elif json.loads(os.environ[START])["study"] != stated_hash(study):
        raise WorkflowError("refused: the configuration was edited after the start; start again")
