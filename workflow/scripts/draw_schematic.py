"""Draw Fig. 1, 2, 3 or 4 from the model's own geometry."""

import argparse
import json
from pathlib import Path

from model.physics.parameters import Parameters
from model.show.schematics import DRAWINGS
from model.show.style import save


def main() -> None:
    """Read the command line and do it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--figure", required=True, choices=sorted(DRAWINGS))
    parser.add_argument("--parameters", required=True, type=json.loads)
    parser.add_argument("--output", required=True, type=Path, help="the PNG; SVG and PDF beside it")
    arguments = parser.parse_args()
    figure = DRAWINGS[arguments.figure](Parameters(**arguments.parameters))
    save(figure, arguments.output.with_suffix(""))


if __name__ == "__main__":
    main()
