"""Functions that the rules share: hashes of their scripts' code, and plans as plain values."""

from pathlib import Path

from study.plans import sweep_of
from study.tracking.code import code_of


def code(script):
    """Return params with a hash of each file that a script imports, so that an edit reruns its jobs.

    Snakemake names the files that differ as the reason of a rerun: `snakemake -n --quiet host`.
    """
    return code_of(Path(workflow.basedir), f"workflow/scripts/{script}.py")


def stated(plan):
    """Return a plan as plain values; Snakemake compares these, but silently ignores models."""
    return plan.model_dump(mode="json")


def pictures(*places):
    """Return the files of pictures, given by their paths without extension."""
    return [f"<results>/{place}{kind}" for place in places for kind in (".png", ".svg", ".pdf")]


def sweep(wildcards):
    """Return the sweep of a figure or map."""
    return stated(sweep_of(study, wildcards.name))


def chunks(wildcards):
    """Return the number of chunks of a figure or map."""
    return study.spec_of(wildcards.name).chunks


def numbers_of_part(wildcards):
    """Return the seed of the campaign, the first set of a part, and the number of its sets."""
    campaign = study.accuracy.fuzz
    first = int(wildcards.chunk) * campaign.sets_a_job
    count = min(campaign.sets_a_job, campaign.sets - first)
    return {"seed": campaign.seed, "first": first, "count": count}
