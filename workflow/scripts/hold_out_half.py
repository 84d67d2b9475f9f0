"""Search on the figures of one half, and judge those of the other."""

from pathlib import Path

from model.sweeps.files import write_text
from study.config.identification import HoldOut
from study.identification.hold_out import hold_out
from study.identification.space import Space
from study.tracking.records import recorded, snakemake

with recorded(snakemake, part=True):
    seen, unseen = (Space.model_validate(snakemake.params[name]) for name in ("seen", "unseen"))
    devices = hold_out(seen, unseen, HoldOut.model_validate(snakemake.params.effort))
    write_text(devices.to_csv(index=False), Path(snakemake.output.devices))
