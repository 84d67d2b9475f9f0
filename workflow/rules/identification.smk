"""The parameters that the paper leaves unstated: `snakemake -c2 identification`, apart from the study."""

from model.physics.readings import READING_NAMES
from model.study.config import CURVES
from model.study.identification.candidate import space_of, space_of_reading
from model.study.identification.committed import PICTURES as IDENTIFIED_PICTURES
from model.study.identification.committed import TABLES

# What was found is committed: these tables are made by `identification`, and then copied there.
identified_tables = [Path(f"config/identification/{table}.csv") for table in TABLES]
if not all(table.is_file() for table in identified_tables):
    identified_tables = []
identified_pictures = [
    root / place for place in (IDENTIFIED_PICTURES.values() if identified_tables else [])
]

banded = space_of(study).only(CURVES)  # the curves that it computes

job(
    "draw_identification",
    dict(pictures=pictures(root / "figures/identified_{picture}")),
    dict(tables=identified_tables),
    dict(
        picture=lambda wildcards: wildcards.picture,
        structure=study.structure,
        law=study.identification.law,
    ),
    wildcards=dict(picture="structure|claims|readings"),
    message="identification: drawing {wildcards.picture}",
    reported=("Identification", "identification"),
    local=True,
)

job(
    "identified_bands",
    dict(data=root / "data/identified_bands.csv"),
    dict(**after_kernels, tables=identified_tables),
    dict(space=banded),
    message="identification: the admissible sets on the curves of Figs. 6 to 12",
)

job(
    "draw_bands",
    dict(pictures=pictures(root / "figures/identified_bands")),
    dict(
        bands=root / "data/identified_bands.csv",
        curves=expand(root / "data/{figure}.nc", figure=banded.figures),
    ),
    message="identification: drawing the bands",
    reported=("Identification", "identification"),
    local=True,
)

# A reading is a preset, or the one reading that is corrected while all others stay as printed.
READINGS = ["consistent", "printed", *READING_NAMES]
law = study.identification
found = root / "identification"
samples = dict(samples=expand(found / "samples/{chunk}.nc", chunk=range(law.pool.chunks)))


def known_to(wildcards):
    """Return the known sets for the last of the searches over all claims, none for the others.

    Half of a first population of known sets would keep a search in their neighbourhood; and what was
    found with all claims would tell of those held out.
    """
    is_last = (wildcards.kind, int(wildcards.number)) == ("start", law.starts - 1)
    return law.known if is_last else {}


job(
    "identify_sample",
    dict(data=found / "samples/{chunk}.nc"),
    after_kernels,
    dict(space=space_of(study), pool=law.pool, chunk=lambda wildcards: int(wildcards.chunk)),
    message="identification: first samples, chunk {wildcards.chunk}",
)

job(
    "identify_search",
    dict(data=found / "{kind}{number}.nc"),
    samples,
    dict(
        space=space_of(study),
        rounds=lambda wildcards: law.rounds if wildcards.kind == "start" else law.half,
        known=known_to,
        kind=lambda wildcards: wildcards.kind,
        number=lambda wildcards: int(wildcards.number),
    ),
    wildcards=dict(kind="start|half", number=r"\d+"),
    message="identification: search {wildcards.kind} {wildcards.number}",
)

job(
    "identify_reading",
    dict(data=found / "readings/{reading}.nc"),
    samples,
    dict(
        space=lambda wildcards: space_of_reading(study, wildcards.reading),
        reading=lambda wildcards: wildcards.reading,
        rounds=law.reading_rounds,
    ),
    wildcards=dict(reading="|".join(READINGS)),
    message="identification: under the reading {wildcards.reading}",
)

job(
    "identify_summary",
    dict(
        text=found / "summary.txt",
        best=found / "best.yaml",
        ensemble=found / "ensemble.nc",
        tables=expand(found / "{table}.csv", table=TABLES),
    ),
    dict(
        **samples,
        starts=expand(found / "start{k}.nc", k=range(law.starts)),
        half=expand(found / "half{k}.nc", k=range(law.splits)),
        readings=expand(found / "readings/{reading}.nc", reading=READINGS),
    ),
    dict(study=study),
    message="identification: the best set, the ensemble, splits and readings",
    local=True,
)

printed("identification", found / "summary.txt", "the result of the identification")
