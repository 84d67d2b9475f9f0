"""Print a text; fail if its last line does not contain the param ``must_end``."""

import sys
from pathlib import Path

from study.tracking.records import snakemake

text = Path(snakemake.input[0]).read_text(encoding="utf-8")
Path(snakemake.log[0]).write_text(text, encoding="utf-8")
sys.stdout.write(text)
if snakemake.params.must_end not in text.splitlines()[-1]:
    sys.exit(1)
