"""Draw Fig. 1, 2, 3 or 4 from the model's own geometry, with a sidecar."""

import argparse
import json
from pathlib import Path

from model.physics.parameters import Parameters
from model.show.schematics import DRAWINGS
from model.show.style import save
from model.tracking.provenance import Job


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--figure", required=True, choices=sorted(DRAWINGS))
    parser.add_argument("--parameters", required=True, type=json.loads)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    parser.add_argument("--record", required=True, type=Path)
    arguments = parser.parse_args()
    job = Job("schematic", arguments.figure)
    figure = DRAWINGS[arguments.figure](Parameters(**arguments.parameters))
    pictures = save(figure, arguments.output.with_suffix(""))
    job.finish(arguments.record, pictures, parameters=arguments.parameters)


if __name__ == "__main__":
    main()
