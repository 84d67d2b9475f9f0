"""Check the properties of runs on a part of the random sets of `make fuzz`."""

from pathlib import Path

from model.sweeps.files import write_text
from study.tracking.records import recorded, snakemake
from verification.fuzz_campaign import report_text, try_part

with recorded(snakemake, part=True) as metadata:
    first, count = (snakemake.params.numbers[name] for name in ("first", "count"))
    report = try_part(snakemake.wildcards.scene, snakemake.params.numbers["seed"], first, count)
    write_text(report_text(report), Path(snakemake.output.found))
    metadata["counts"] = {"trajectories": count, "sensitive": report.sensitive}
