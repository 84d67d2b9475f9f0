"""Snakemake's logger plug-in `vibralign`: it records invocations that start no job.

The profiles select it. Snakemake finds a plug-in by the name of its module, and logs to it from its
main process only.
"""

from logging import LogRecord

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from model.tracking.invocation import Watch


class LogHandler(LogHandlerBase):
    """Passes Snakemake's events to a ``Watch``, and prints nothing."""

    writes_to_stream = False
    writes_to_file = False
    has_filter = True
    has_formatter = True
    needs_rulegraph = False

    def __post_init__(self) -> None:
        """Make the ``Watch``, before the Snakefile is read."""
        self._watch = Watch(plans=self.common_settings.dryrun)

    def emit(self, record: LogRecord) -> None:
        """Note an event."""
        event = getattr(record, "event", None)
        if event == LogEvent.WORKFLOW_STARTED:
            self._watch.executes = True
        elif event == LogEvent.JOB_STARTED:
            self._watch.jobs = True
        elif event == LogEvent.ERROR:
            lines = record.getMessage().splitlines()
            self._watch.error = "; ".join(line.strip() for line in lines if line.strip())

    def close(self) -> None:
        """Record an invocation that no handler of the Snakefile recorded."""
        self._watch.close()
        super().close()
