"""Compute the trajectories that the claims ledger needs beside the figures'."""

import argparse
from collections import Counter
from pathlib import Path

from pydantic import RootModel

from model.study.claims.runs import claim_run_dataset
from model.study.datasets import outcome_counts, write_dataset
from model.study.sweeps import Sweep
from model.tracking.provenance import Job


class Runs(RootModel[dict[str, tuple[str, Sweep]]]):
    """Title and sweep of every run, by its name."""


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", required=True, type=Runs.model_validate_json)
    parser.add_argument("--output", required=True, type=Path, help="folder of the datasets")
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    runs = arguments.runs.root
    job = Job("claims_runs")
    made, counts = [], Counter[str]()
    for name, (title, sweep) in runs.items():
        dataset = claim_run_dataset(sweep, title)
        made.append(arguments.output / f"{name}.nc")
        write_dataset(dataset, made[-1])
        counts += Counter(outcome_counts(dataset))
    identities = {name: sweep.identity for name, (_, sweep) in runs.items()}
    job.finish(arguments.record, made, sweeps=identities, counts=dict(counts))


if __name__ == "__main__":
    main()
