"""Judge the paper's claims by the datasets of the study."""

from pathlib import Path

from model.sweeps.files import write_text
from model.sweeps.io import read_dataset
from study.claims import Tables, judge
from study.claims.ledger import ledger_text, lines_of
from study.evidence.worth import weighed
from study.tracking.records import recorded, snakemake

with recorded(snakemake):
    datasets = {Path(file).stem: read_dataset(Path(file)) for file in snakemake.input}
    null = datasets.pop("null")
    lines = weighed(lines_of(judge(Tables.of(datasets))), null)
    write_text(ledger_text(lines), Path(snakemake.output.table))
