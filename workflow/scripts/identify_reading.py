"""Search under one reading of the equations; all readings have the same start and budget."""

import argparse
from pathlib import Path

from pydantic import TypeAdapter

from model.study.config import Evolution
from model.study.datasets import read_dataset, write_dataset
from model.study.identification.candidate import Space
from model.study.identification.results import candidates_dataset, samples_of, search_of
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--space", required=True, type=Space.model_validate_json)
    parser.add_argument("--reading", required=True)
    parser.add_argument("--rounds", required=True, type=TypeAdapter(list[Evolution]).validate_json)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("samples", nargs="+", type=Path, help="of the consistent reading")
    arguments = parser.parse_args()
    space, job = arguments.space, Job("identify_reading", arguments.reading)
    search = search_of(space)
    samples = samples_of([read_dataset(path) for path in arguments.samples])
    found = search.run(samples, arguments.rounds, 0)
    title = f"Candidates under the reading {arguments.reading}"
    write_dataset(candidates_dataset(search, *found, title), arguments.output)
    job.finish(arguments.record, [arguments.output], arguments.samples, sweep=space.identity)


if __name__ == "__main__":
    main()
