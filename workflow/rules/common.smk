"""What the rules share: how the parts of a figure or trial are named and described."""

import json
from pathlib import Path

from model.physics.readings import READING_NAMES
from model.study.identification.candidate import space_of, space_of_reading
from model.study.identification.committed import PICTURES as IDENTIFIED_PICTURES
from model.study.identification.committed import TABLES
from verification.plans import HARD_PICTURES, PICTURES
from model.tracking.provenance import code_hash
from model.study.sweeps import claim_sweep, sweep_of
from verification.trials import trial_of

computed = HISTORIES + gridded
invocation.state(study=study.model_dump(mode="json"))


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


def shown(figure):
    """The dataset that a figure's pictures are drawn from."""
    return root / (f"data/maps/{figure}.nc" if figure in MAPS else f"data/{figure}.nc")


def records_beside():
    """The sidecars of the jobs on speed against error and hard cases, which are no figure's."""
    jobs = ["data/precision", *PICTURES.values(), "data/hard_cases", *HARD_PICTURES.values()]
    jobs += [f"data/fixed_steps/{figure}" for figure in study.precision.fixed_steps.figures]
    return [root / f"{job}.run.json" for job in ["data/unlocated_kernels", *jobs]]


def runs_of_claims():
    """Title and computation of every run that only the ledger reads, as JSON."""
    runs = {
        name: (run.title, claim_sweep(study, name).model_dump(mode="json"))
        for name, run in study.claims_runs.items()
    }
    return json.dumps(runs)


def records_of_claims():
    """The sidecars of the jobs on the claims ledger, and on the base."""
    jobs = ["data/claims/runs", "claims", "figures/claims", "figures/contact_stiffness"]
    jobs += [f"data/contact_stiffness/{name}" for name in study.contact_stiffness.figures]
    return [root / f"{job}.run.json" for job in jobs]


def records(figure):
    """The sidecars of a figure's jobs."""
    found = [root / f"figures/{figure}.run.json"]
    if figure in computed:
        found += [root / f"data/{figure}.run.json"]
    if figure in gridded:
        chunks = range(study.figures[figure].chunks)
        found += [root / f"data/chunks/{figure}/{chunk}.run.json" for chunk in chunks]
    if figure in MAPS:
        parts = [figure, *[f"{figure}/{part}" for part in range(study.maps.chunks)]]
        found += [root / f"data/maps/{part}.run.json" for part in parts]
    return found


def trial(name):
    """An accuracy trial's computation as JSON."""
    return trial_of(study, name).model_dump_json()


def trial_chunks(name):
    """An accuracy trial's chunks."""
    law = study.accuracy if name == "error" else study.accuracy.settled
    return expand(root / f"accuracy/{name}/{{chunk}}.csv", chunk=range(law.chunks))


def rounds(evolutions):
    """How far a search is carried on, as JSON."""
    return json.dumps([each.model_dump() for each in evolutions])


def known_to(kind, number):
    """The known sets, as JSON, for the last of the searches over all claims, none for the others.

    Half of a first population of known sets would keep a search in their neighbourhood; and what was
    found with all claims would tell of those held out.
    """
    is_last = (kind, int(number)) == ("start", study.identification.starts - 1)
    return json.dumps(study.identification.known if is_last else {})
