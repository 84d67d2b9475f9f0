"""What the rules share: how a figure's parts are named and described."""

import sys
from pathlib import Path

from model.study.provenance import code_hash
from model.study.sweeps import sweep_of
from model.study.tracking import Invocation

invocation = Invocation(root, study=study.model_dump(mode="json"))
if workflow.is_main_process:
    invocation.announce()


def code(script):
    """Hash of what a rule's script runs: an edit reruns exactly what depends on it."""
    return code_hash(Path(workflow.basedir), f"workflow/scripts/{script}.py")


def sweep(figure):
    """A figure's computation as JSON: it changes only when the numbers do."""
    return sweep_of(study, figure).model_dump_json()


def label(figure):
    """A figure's wording, which computes nothing."""
    return {"title": study.figures[figure].title, "summary": study.figures[figure].sees}


def drawn(figure):
    """A figure's pictures."""
    return expand(root / f"figures/{figure}.{{kind}}", kind=["png", "svg", "pdf"])


def records(figure):
    """The sidecars of a figure's jobs."""
    found = [root / f"figures/{figure}.run.json"]
    if figure in computed:
        found += [root / f"data/{figure}.run.json"]
    if figure in gridded:
        chunks = range(study.figures[figure].chunks)
        found += [root / f"data/chunks/{figure}/{chunk}.run.json" for chunk in chunks]
    return found


onstart:
    invocation.start()


onsuccess:
    invocation.end("done", log)


onerror:
    print(*invocation.end("failed", log), sep="\n", file=sys.stderr)
