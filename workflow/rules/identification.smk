"""The parameters that the paper leaves unstated: `snakemake -c2 identification`, apart from the study."""

from model.physics.readings import READING_NAMES
from model.study.config import CURVES
from model.study.identification.candidate import space_of, space_of_reading
from model.study.identification.committed import PICTURES as IDENTIFIED_PICTURES
from model.study.identification.committed import TABLES
from model.study.identification.regimes import PRESENT, own_set
from model.study.identification.results import FINER

# What was found is committed: these tables are made by `identification`, and then copied there.
identified_tables = [Path(f"config/identification/{table}.csv") for table in TABLES]
if not all(table.is_file() for table in identified_tables):
    identified_tables = []
identified_pictures = [
    root / place for place in (IDENTIFIED_PICTURES.values() if identified_tables else [])
]

banded = space_of(study).only(CURVES)  # the curves that it computes
finer = space_of(study, FINER)

job(
    "draw_identification",
    dict(pictures=pictures(root / "figures/identified_{picture}")),
    dict(tables=identified_tables),
    dict(
        picture=lambda wildcards: wildcards.picture,
        structure=study.structure,
        law=study.identification.law,
        aims=study.identification.aims,
    ),
    wildcards=dict(picture="structure|claims|readings|front|budget"),
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

job(
    "regimes",
    dict(table=root / "data/regimes.csv"),
    after_kernels,
    dict(
        space=finer.only(finer.figures),
        sets={**study.identification.compared, PRESENT: own_set(study)},
    ),
    message="identification: the regime of every figure, of the sets compared and of the study's device",
)

# A reading is a preset, or the one reading that is corrected while all others stay as printed.
READINGS = ["consistent", "printed", *READING_NAMES]
law = study.identification
found = root / "identification"
samples = dict(samples=expand(found / "samples/{chunk}.nc", chunk=range(law.pool.chunks)))


def start_of(wildcards):
    """Return the search over all claims, None for one over a half of them.

    Those begin from no known sets: what was found with all claims would tell of those held out.
    """
    return law.starts[int(wildcards.number)] if wildcards.kind == "start" else None


def rounds_of(kind):
    return law.rounds if kind == "start" else law.half


def round_before(wildcards):
    """Return the round that a round continues, none for the first."""
    stage = int(wildcards.stage)
    return [found / f"{wildcards.kind}{wildcards.number}/{stage - 1}.nc"] if stage else []


def last_rounds(kind, count):
    return expand(found / f"{kind}{{k}}/{len(rounds_of(kind)) - 1}.nc", k=range(count))


job(
    "identify_sample",
    dict(data=found / "samples/{chunk}.nc"),
    after_kernels,
    dict(space=space_of(study), pool=law.pool, chunk=lambda wildcards: int(wildcards.chunk)),
    message="identification: first samples, chunk {wildcards.chunk}",
)

job(
    "identify_search",
    dict(data=found / "{kind}{number}/{stage}.nc"),
    dict(**samples, before=round_before),
    dict(
        space=space_of(study),
        evolution=lambda wildcards: rounds_of(wildcards.kind)[int(wildcards.stage)],
        known=lambda wildcards: (
            law.known if (start := start_of(wildcards)) and start.known else {}
        ),
        kind=lambda wildcards: wildcards.kind,
        number=lambda wildcards: int(wildcards.number),
        stage=lambda wildcards: int(wildcards.stage),
        weight=lambda wildcards: start.weight if (start := start_of(wildcards)) else 1.0,
    ),
    wildcards=dict(kind="start|half", number=r"\d+", stage=r"\d+"),
    message="identification: search {wildcards.kind} {wildcards.number}, round {wildcards.stage}",
)

job(
    "identify_descent",
    dict(data=found / "descent/{stage}.nc"),
    dict(
        starts=last_rounds("start", len(law.starts)),
        before=lambda wildcards: (
            [found / f"descent/{int(wildcards.stage) - 1}.nc"] if int(wildcards.stage) else []
        ),
    ),
    dict(
        space=space_of(study),
        aims=law.aims,
        descent=lambda wildcards: law.descents[int(wildcards.stage)],
        stage=lambda wildcards: int(wildcards.stage),
    ),
    wildcards=dict(stage=r"\d+"),
    message="identification: search by the aims, round {wildcards.stage}",
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
        starts=last_rounds("start", len(law.starts)),
        descent=found / f"descent/{len(law.descents) - 1}.nc",
        half=last_rounds("half", law.splits),
        readings=expand(found / "readings/{reading}.nc", reading=READINGS),
    ),
    dict(study=study),
    message="identification: the best set, the ensemble, splits and readings",
    local=True,
)

printed("identification", found / "summary.txt", "the result of the identification")
