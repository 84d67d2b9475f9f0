"""Compute the trajectories that the claims ledger needs beside the figures'.

One job, because a start of Python costs as much as most of these runs.
"""

from collections import Counter
from pathlib import Path
from typing import Any

from model.study.claims.runs import claim_run_dataset
from model.study.datasets import outcome_counts, write_dataset
from model.study.sweeps import Sweep


def run(sweeps: dict[str, Sweep], titles: dict[str, str], data: list[Path]) -> dict[str, Any]:
    """Write a dataset for each sweep, in their order."""
    counts = Counter[str]()
    for (name, sweep), path in zip(sweeps.items(), data, strict=True):
        dataset = claim_run_dataset(sweep, titles[name])
        write_dataset(dataset, path)
        counts += Counter(outcome_counts(dataset))
    identities = {name: sweep.identity for name, sweep in sweeps.items()}
    return {"sweeps": identities, "counts": dict(counts)}
