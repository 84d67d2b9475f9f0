"""Pictures and the report: drawings of the model, plots of the datasets, one page of everything."""

import json


rule schematic:
    output:
        png=root / "figures/{figure}.png",
        svg=root / "figures/{figure}.svg",
        pdf=root / "figures/{figure}.pdf",
        record=root / "figures/{figure}.run.json",
    log:
        root / "logs/schematic/{figure}.log",
    wildcard_constraints:
        figure="|".join(SCHEMATICS),
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_schematic"),
        parameters=lambda wildcards: json.dumps(study.parameters(wildcards.figure).given()),
    message:
        "{wildcards.figure}: drawing the model"
    shell:
        "python workflow/scripts/draw_schematic.py --figure {wildcards.figure}"
        " --parameters {params.parameters:q} --output {output.png}"
        " --record {output.record} > {log} 2>&1"


rule plot:
    input:
        lambda wildcards: shown(wildcards.figure),
    output:
        png=root / "figures/{figure}.png",
        svg=root / "figures/{figure}.svg",
        pdf=root / "figures/{figure}.pdf",
        record=root / "figures/{figure}.run.json",
    log:
        root / "logs/plot/{figure}.log",
    wildcard_constraints:
        figure="|".join(computed),
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_plot"),
    message:
        "{wildcards.figure}: plotting"
    shell:
        "python workflow/scripts/draw_plot.py --output {output.png}"
        " --record {output.record} {input} > {log} 2>&1"


rule report:
    input:
        data=expand(root / "data/{figure}.nc", figure=computed),
        pictures=[drawn(figure) for figure in FIGURES],
        times=root / "benchmarks/precision.csv",
        fixed_steps=expand(
            root / "data/fixed_steps/{figure}.nc", figure=study.precision.fixed_steps.figures
        ),
        comparison=[pictured(place) for place in PICTURES.values()],
        claims=[root / "claims.csv", *pictured("figures/claims")],
        bases=[*contact_data, *pictured("figures/contact_stiffness")],
        identified=identified_tables,
        identified_pictures=[pictured(place) for place in identified_pictures],
        hard_times=root / "benchmarks/hard_cases.csv",
        hard=[pictured(place) for place in HARD_PICTURES.values()],
    output:
        page=root / "report.html",
        record=root / "report.run.json",
    log:
        root / "logs/report.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("render_report"),
        study=study.model_dump_json(),
        root=root,
    message:
        "rendering the report"
    shell:
        "python workflow/scripts/render_report.py --study {params.study:q}"
        " --root {params.root} --output {output.page} --record {output.record}"
        " --identified {input.identified} > {log} 2>&1"


# The index of all runs. Snakemake's handlers write it anew when an invocation ends, so that one of
# a single figure, and one that failed, is in it as well.
rule index:
    input:
        root / "data/kernels.run.json",
        root / "report.run.json",
        [records(figure) for figure in FIGURES],
        records_beside(),
        records_of_claims(),
        [root / f"{place}.run.json" for place in identified_pictures],
        [root / "data/identified_bands.run.json"] if identified_tables else [],
    output:
        root / "runs.csv",
    log:
        root / "logs/index.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("index_runs"),
        root=root,
    message:
        "indexing all runs"
    shell:
        "python workflow/scripts/index_runs.py --root {params.root} > {log} 2>&1"


# `snakemake -c2 fig06` builds one figure.
for name in FIGURES:

    rule:
        name:
            name
        input:
            drawn(name),
