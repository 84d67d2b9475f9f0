"""Snakemake's logger plug-in `vibralign`: it records invocations that start no job.

The profiles select it. Snakemake finds a plug-in by the name of its module, and logs to it from its
main process only.
"""

import contextlib
import sys
from logging import LogRecord

from snakemake.exceptions import WorkflowError
from snakemake.logging import logger
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from study.tracking import TrackingError, invocation


class LogHandler(LogHandlerBase):
    """Notes what Snakemake does, and prints nothing."""

    writes_to_stream = False
    writes_to_file = False
    has_filter = True
    has_formatter = True
    needs_rulegraph = False

    def __post_init__(self) -> None:
        """Begin before the Snakefile is read."""
        self.plans = self.common_settings.dryrun
        self.invocation: invocation.Invocation | None = None
        self._executes = False  # jobs are to run; not for a list, a lint and the like
        self._jobs = False  # one has started
        self._error: str | None = None  # the last one
        invocation.logger = self
        logger.addFilter(self._before)

    def _before(self, record: LogRecord) -> bool:
        """Lock and mend the folder before Snakemake looks at its files, and before the first job.

        Snakemake calls this at once, and ``emit`` from another thread.
        """
        event, own = getattr(record, "event", None), self.invocation
        if own is None or self.plans:
            return True
        if event == LogEvent.WORKFLOW_STARTED:
            with contextlib.suppress(TrackingError):  # nothing is refused if there are no jobs
                own.recover()
        elif event == LogEvent.RUN_INFO:  # also without hooks
            try:
                own.recover(invocation.PATIENCE)
            except TrackingError as refused:
                raise WorkflowError(str(refused)) from None
        return True

    def emit(self, record: LogRecord) -> None:
        """Note an event."""
        event = getattr(record, "event", None)
        if event == LogEvent.WORKFLOW_STARTED:
            self._executes = True
        elif event == LogEvent.JOB_STARTED:
            self._jobs = True
        elif event == LogEvent.ERROR:
            lines = record.getMessage().splitlines()
            self._error = "; ".join(line.strip() for line in lines if line.strip())

    def close(self) -> None:
        """Record an invocation that started no job, unless it is a dry run."""
        super().close()
        if self.plans or self.invocation is None or self._jobs:
            return
        if isinstance(sys.exc_info()[1], KeyboardInterrupt):
            self.invocation.record_idle("interrupted", "interrupted before the first job")
        elif self._error is not None:
            self.invocation.record_idle("failed", self._error)
        elif self._executes:
            self.invocation.record_idle("done")
