"""Draw a schematic of the model."""

from pathlib import Path
from typing import Any

from model.physics.parameters import Parameters
from model.show.schematics import DRAWINGS
from model.show.style import save


def run(figure: str, parameters: dict[str, Any], pictures: list[Path]) -> dict[str, Any]:
    """Draw ``figure`` for a part of these parameters."""
    save(DRAWINGS[figure](Parameters(**parameters)), pictures[0].with_suffix(""))
    return {"parameters": parameters}
