"""Run one chunk of an accuracy trial."""

import argparse
from pathlib import Path

from model.tracking.provenance import Job
from verification.accuracy import run_trial, write_table
from verification.trials import Trial


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trial", required=True, type=Trial.model_validate_json)
    parser.add_argument("--chunk", required=True, type=int)
    parser.add_argument("--chunks", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    trial: Trial = arguments.trial
    job = Job("trial", trial.name, arguments.chunk)
    table = run_trial(trial, arguments.chunk, arguments.chunks)
    write_table(table, arguments.output)
    counts = {"trajectories": int(table["set"].size)}
    job.finish(arguments.record, [arguments.output], **trial.facts, counts=counts)


if __name__ == "__main__":
    main()
