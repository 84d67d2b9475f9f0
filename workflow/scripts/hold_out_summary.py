"""Sum up what devices show of figures that the search has not seen."""

from pathlib import Path

import pandas as pd

from model.sweeps.files import write_text
from study.identification.hold_out import summary_of
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    halves = {half: pd.read_csv(file) for half, file in snakemake.input.items()}
    for name, table in zip(("counts", "claims"), summary_of(halves), strict=True):
        text = table.to_csv(index=False, float_format="%.3g")
        write_text(text, Path(snakemake.output[name]))
