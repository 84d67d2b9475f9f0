"""What the rules share: how the parts of a figure or trial are named and described."""

from pathlib import Path

from model.study.accuracy import trial_of
from model.study.plans import PICTURES
from model.study.provenance import code_hash
from model.study.sweeps import sweep_of


def code(script):
    """Hash of what a rule's script runs: an edit reruns exactly what depends on it."""
    return code_hash(Path(workflow.basedir), f"workflow/scripts/{script}.py")


def sweep(figure):
    """A figure's computation as JSON: it changes only when the numbers do."""
    return sweep_of(study, figure).model_dump_json()


def label(figure):
    """A figure's wording, which computes nothing."""
    return {"title": study.figures[figure].title, "summary": study.figures[figure].sees}


def pictured(place):
    """A picture of the section on speed against error."""
    return multiext(str(root / place), ".png", ".svg", ".pdf")


def drawn(figure):
    """A figure's pictures."""
    return expand(root / f"figures/{figure}.{{kind}}", kind=["png", "svg", "pdf"])


def trial(name):
    """An accuracy trial's computation as JSON."""
    return trial_of(study, name).model_dump_json()


def trial_chunks(name):
    """An accuracy trial's chunks."""
    law = study.accuracy if name == "error" else study.accuracy.settled
    return expand(root / f"accuracy/{name}/{{chunk}}.csv", chunk=range(law.chunks))
