"""Judge the entries of the ledger by the datasets of the figures."""

from pathlib import Path

from model.sweeps.files import write_text
from model.sweeps.io import read_dataset
from model.sweeps.settings import RunSettings
from study.claims import figure_of, judge
from study.claims.ledger import ledger_text, lines_of
from study.claims.locked import locked_of
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    figures = {
        Path(file).stem: figure_of(read_dataset(Path(file))) for file in snakemake.input.figures
    }
    settings = RunSettings.model_validate(snakemake.params.settings).settings
    figures["locked"] = locked_of(figures, settings)
    lines = lines_of(judge(figures), snakemake.params.shares)
    write_text(ledger_text(lines), Path(snakemake.output.table))
