"""Draw a schematic of the model."""

from pathlib import Path

from model.physics.parameters import Parameters
from study.schematics import DRAWINGS
from study.tracking.records import recorded, snakemake
from vibralign.plots.style import save

with recorded(snakemake) as metadata:
    metadata["parameters"] = snakemake.params.parameters
    draw = DRAWINGS[snakemake.wildcards.figure]
    figure = draw(Parameters(**snakemake.params.parameters))
    save(figure, Path(snakemake.output.png).with_suffix(""))
