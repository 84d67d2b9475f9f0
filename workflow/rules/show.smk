"""Pictures and the report: drawings of the model, plots of the datasets, one page of everything."""

import json


rule schematic:
    output:
        png=root / "figures/{figure}.png",
        svg=root / "figures/{figure}.svg",
        pdf=root / "figures/{figure}.pdf",
    log:
        root / "logs/figures/{figure}.log",
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
        " --parameters {params.parameters:q} --output {output.png} > {log} 2>&1"


rule plot:
    input:
        root / "data/{figure}.nc",
    output:
        png=root / "figures/{figure}.png",
        svg=root / "figures/{figure}.svg",
        pdf=root / "figures/{figure}.pdf",
    log:
        root / "logs/figures/{figure}.log",
    wildcard_constraints:
        figure="|".join(computed),
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_plot"),
    message:
        "{wildcards.figure}: plotting"
    shell:
        "python workflow/scripts/draw_plot.py --output {output.png} {input} > {log} 2>&1"


rule report:
    input:
        data=expand(root / "data/{figure}.nc", figure=computed),
        pictures=[drawn(figure) for figure in FIGURES],
        times=root / "benchmarks/precision.csv",
        fixed_steps=expand(
            root / "data/fixed_steps/{figure}.nc", figure=study.precision.fixed_steps.figures
        ),
        comparison=[pictured(place) for place in PICTURES.values()],
    output:
        root / "report.html",
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
        " --root {params.root} --output {output} > {log} 2>&1"


# `snakemake -c2 fig06` builds one figure.
for name in FIGURES:

    rule:
        name:
            name
        input:
            drawn(name),
