"""Recording: an invocation locks the folder and leaves a record; jobs refuse code edited since."""

import sys

from study.tracking import TrackingError
from study.tracking.job import announce

try:
    announce(study.model_dump_json(), Path(workflow.basedir))
except TrackingError as edited:
    raise WorkflowError(str(edited))


onstart:
    try:
        invocation.start()
    except TrackingError as refused:
        raise WorkflowError(str(refused))


onsuccess:
    invocation.end("done", *log[:1])


onerror:
    print(*invocation.end("failed", *log[:1]), sep="\n", file=sys.stderr)
