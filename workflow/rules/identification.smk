"""What the paper leaves unstated, identified: `snakemake -c2 identification`, apart from the study."""

import json

# What was found is committed: these tables are made by `identification`, and then copied there.
identified_tables = [Path(f"config/identification/{table}.csv") for table in TABLES]
if not all(table.is_file() for table in identified_tables):
    identified_tables = []
identified_pictures = IDENTIFIED_PICTURES.values() if identified_tables else []


rule draw_identification:
    input:
        identified_tables,
    output:
        png=root / "figures/identified_{picture}.png",
        svg=root / "figures/identified_{picture}.svg",
        pdf=root / "figures/identified_{picture}.pdf",
        record=root / "figures/identified_{picture}.run.json",
    log:
        root / "logs/draw_identification/{picture}.log",
    wildcard_constraints:
        picture="structure|claims|readings",
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_identification"),
        structure=json.dumps(study.structure),
        law=study.identification.law.model_dump_json(),
    message:
        "identification: drawing {wildcards.picture}"
    shell:
        "python workflow/scripts/draw_identification.py --picture {wildcards.picture}"
        " --structure {params.structure:q} --law {params.law:q}"
        " --output {output.png} --record {output.record} --tables {input} > {log} 2>&1"


rule identified_bands:
    input:
        tables=identified_tables,
        kernels=root / "data/kernels.json",
    output:
        data=root / "data/identified_bands.csv",
        record=root / "data/identified_bands.run.json",
    log:
        root / "logs/identified_bands.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compute_bands"),
        space=space_of(study).only(CURVES).model_dump_json(),
    message:
        "identification: what the admissible sets give on the curves of Figs. 6 to 12"
    shell:
        "python workflow/scripts/compute_bands.py --space {params.space:q}"
        " --output {output.data} --record {output.record} {input.tables} > {log} 2>&1"


rule draw_bands:
    input:
        bands=root / "data/identified_bands.csv",
        curves=expand(root / "data/{figure}.nc", figure=CURVES),
    output:
        png=root / "figures/identified_bands.png",
        svg=root / "figures/identified_bands.svg",
        pdf=root / "figures/identified_bands.pdf",
        record=root / "figures/identified_bands.run.json",
    log:
        root / "logs/draw_bands.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_bands"),
    message:
        "identification: drawing the bands"
    shell:
        "python workflow/scripts/draw_bands.py --bands {input.bands}"
        " --output {output.png} --record {output.record} {input.curves} > {log} 2>&1"


# A reading is a preset, or the one switch that is corrected while all others stay as printed.
ROUNDS = {"start": "rounds", "half": "half"}
READINGS = ["consistent", "printed", *READING_NAMES]


rule identify_sample:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / "identification/samples/{chunk}.nc",
        record=root / "identification/samples/{chunk}.run.json",
    log:
        root / "logs/identify_sample/{chunk}.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("identify_sample"),
        space=space_of(study).model_dump_json(),
        pool=study.identification.pool.model_dump_json(),
    message:
        "identification: first samples, chunk {wildcards.chunk}"
    shell:
        "python workflow/scripts/identify_sample.py --space {params.space:q}"
        " --pool {params.pool:q} --chunk {wildcards.chunk}"
        " --output {output.data} --record {output.record} > {log} 2>&1"


rule identify_search:
    input:
        expand(
            root / "identification/samples/{chunk}.nc",
            chunk=range(study.identification.pool.chunks),
        ),
    output:
        data=root / "identification/{kind}{number}.nc",
        record=root / "identification/{kind}{number}.run.json",
    log:
        root / "logs/identify_search/{kind}/{number}.log",
    wildcard_constraints:
        kind="start|half",
        number=r"\d+",
    conda:
        "../envs/study.yaml"
    params:
        code=code("identify_search"),
        space=space_of(study).model_dump_json(),
        rounds=lambda wildcards: rounds(getattr(study.identification, ROUNDS[wildcards.kind])),
        known=lambda wildcards: known_to(wildcards.kind, wildcards.number),
    message:
        "identification: search {wildcards.kind} {wildcards.number}"
    shell:
        "python workflow/scripts/identify_search.py --space {params.space:q}"
        " --rounds {params.rounds:q} --known {params.known:q} --kind {wildcards.kind}"
        " --number {wildcards.number}"
        " --output {output.data} --record {output.record} {input} > {log} 2>&1"


rule identify_reading:
    input:
        expand(
            root / "identification/samples/{chunk}.nc",
            chunk=range(study.identification.pool.chunks),
        ),
    output:
        data=root / "identification/readings/{reading}.nc",
        record=root / "identification/readings/{reading}.run.json",
    log:
        root / "logs/identify_reading/{reading}.log",
    wildcard_constraints:
        reading="|".join(READINGS),
    conda:
        "../envs/study.yaml"
    params:
        code=code("identify_reading"),
        space=lambda wildcards: space_of_reading(study, wildcards.reading).model_dump_json(),
        rounds=rounds(study.identification.reading_rounds),
    message:
        "identification: under the reading {wildcards.reading}"
    shell:
        "python workflow/scripts/identify_reading.py --space {params.space:q}"
        " --reading {wildcards.reading} --rounds {params.rounds:q}"
        " --output {output.data} --record {output.record} {input} > {log} 2>&1"


rule identify_summary:
    input:
        samples=expand(
            root / "identification/samples/{chunk}.nc",
            chunk=range(study.identification.pool.chunks),
        ),
        starts=expand(root / "identification/start{k}.nc", k=range(study.identification.starts)),
        halves=expand(root / "identification/half{k}.nc", k=range(study.identification.splits)),
        readings=expand(root / "identification/readings/{reading}.nc", reading=READINGS),
    output:
        root / "identification/best.yaml",
        root / "identification/ensemble.nc",
        expand(root / "identification/{table}.csv", table=TABLES),
        summary=root / "identification/summary.txt",
        record=root / "identification/summary.run.json",
    log:
        root / "logs/identify_summary.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("identify_summary"),
        study=study.model_dump_json(),
        folder=root / "identification",
    message:
        "identification: the best set, the ensemble, splits and readings"
    shell:
        "python workflow/scripts/identify_summary.py --study {params.study:q}"
        " --output {params.folder} --record {output.record}"
        " --samples {input.samples} --starts {input.starts} --halves {input.halves} --readings {input.readings}"
        " > {log} 2>&1"


# Prints, whether or not anything had to be computed.
rule identification:
    input:
        root / "identification/summary.txt",
    log:
        root / "logs/identification.log",
    conda:
        "../envs/study.yaml"
    message:
        "what the identification found"
    shell:
        "cat {input} | tee {log}"
