"""Judge every claim of the paper by the datasets of the study."""

import argparse
from pathlib import Path

from model.study.claims import judge
from model.study.claims.table import ledger_text, lines_of
from model.study.datasets import read_dataset
from model.tracking.provenance import Job, write_text


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--record", required=True, type=Path)
    parser.add_argument("datasets", nargs="+", type=Path)
    arguments = parser.parse_args()
    job = Job("claims")
    judged = judge({path.stem: read_dataset(path) for path in arguments.datasets})
    write_text(ledger_text(lines_of(judged)), arguments.output)
    job.finish(arguments.record, [arguments.output], arguments.datasets)


if __name__ == "__main__":
    main()
