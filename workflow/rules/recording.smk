"""Every invocation leaves a record, those too for which Snakemake calls no handler."""

import atexit
import sys

from model.tracking.cluster import refuse_held_jobs
from model.tracking.invocation import Invocation
from model.tracking.records import TrackingError

invocation = Invocation(Path("results"))  # until the configuration names another root
unread = ""  # why the rules could not be read; None when they are


def own_log():
    """Snakemake's own log; none of a dry run."""
    return next(iter(workflow.logger_manager.get_logfile()), None)


def record_the_rest():
    """Record what Snakemake calls no handler for: nothing to do, or a stop before the first job."""
    settings = workflow.execution_settings
    if workflow.logger_manager.settings.dryrun or (settings and settings.no_hooks):
        return
    named = config.get("results_root")
    if unread is not None and named and isinstance(named, str):
        invocation.root = Path(named)
    if getattr(sys, "last_type", None) is KeyboardInterrupt:  # what ended this process
        invocation.pass_by("interrupted", own_log(), "interrupted before the first job")
    elif unread is not None:
        invocation.pass_by("failed", own_log(), unread.replace("\n", ": ", 1).replace("\n", "; "))
    elif settings:
        planned = workflow.scheduler is not None and not len(workflow.dag)
        invocation.pass_by("done" if planned else "failed", own_log())


if workflow.is_main_process:
    invocation.announce()
    atexit.register(record_the_rest)


onstart:
    try:
        refuse_held_jobs(Path.cwd())
    except TrackingError as held:
        raise WorkflowError(str(held))
    invocation.start()


onsuccess:
    invocation.end("done", own_log())


onerror:
    print(*invocation.end("failed", own_log()), sep="\n", file=sys.stderr)
