"""Draw a schematic of the model."""

from pathlib import Path

from model.physics.parameters import Parameters
from model.show.schematics import DRAWINGS
from model.show.style import save
from model.tracking.job import recorded, snakemake

with recorded(snakemake) as metadata:
    metadata["parameters"] = snakemake.params.parameters
    draw = DRAWINGS[snakemake.wildcards.figure]
    figure = draw(Parameters(**snakemake.params.parameters))
    save(figure, Path(snakemake.output.png).with_suffix(""))
