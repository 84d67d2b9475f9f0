"""Search over all claims, or over half of them, from the best of the first samples."""

import argparse
import json
from pathlib import Path

import numpy as np
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
    parser.add_argument("--rounds", required=True, type=TypeAdapter(list[Evolution]).validate_json)
    parser.add_argument("--known", required=True, type=json.loads, help="sets to begin at as well")
    parser.add_argument("--kind", required=True, choices=["start", "half"])
    parser.add_argument("--number", required=True, type=int)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("samples", nargs="+", type=Path)
    arguments = parser.parse_args()
    space, number = arguments.space, arguments.number
    job = Job("identify_search", arguments.kind, number)
    search = search_of(space)
    samples = samples_of([read_dataset(path) for path in arguments.samples])
    if arguments.kind == "half":
        search = search.on_half(number)
    begin = [space.point_of(values) for values in arguments.known.values()]
    known = np.array(begin) if begin else None
    first = 0 if arguments.kind == "start" else 1000  # other draws than those over all claims
    found = search.run(samples, arguments.rounds, first + number, known)
    title = f"Candidates of search {arguments.kind} {number}"
    write_dataset(candidates_dataset(search, *found, title), arguments.output)
    job.finish(arguments.record, [arguments.output], arguments.samples, sweep=space.identity)


if __name__ == "__main__":
    main()
