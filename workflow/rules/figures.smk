"""The figures: compiled kernels, chunks of sweeps, one dataset a figure, and its pictures."""


localrules:
    merge,
    schematic,
    plot,


# Compiles once, before jobs that would otherwise all compile at the same time. The output contains the
# hash of the kernels' code. It is a plain input of these jobs, not an `ancient` one: Snakemake does not
# look at params of jobs downstream of one that must run, and would run this rule only.
rule kernels:
    output:
        data="<results>/data/kernels.json",
        record="<results>/data/kernels.run.json",
    log:
        "<results>/logs/kernels.log",
    priority: 3
    resources:
        mem_mb=lambda wildcards, attempt: 4000 * 2 ** (attempt - 1),
    params:
        *code("kernels"),
        parameters=study.baseline.given(),
    message:
        "compiling the kernels"
    script:
        "../scripts/kernels.py"


rule chunk:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/chunks/{figure}/{chunk}.nc",
        record="<results>/data/chunks/{figure}/{chunk}.run.json",
    log:
        "<results>/logs/chunk/{figure}/{chunk}.log",
    priority: 1
    params:
        *code("chunk"),
        sweep=sweep,
        chunks=lambda wildcards: study.figures[wildcards.figure].chunks,
    message:
        "{wildcards.figure}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/chunk.py"


rule merge:
    input:
        lambda wildcards: expand(
            "<results>/data/chunks/{figure}/{chunk}.nc",
            figure=wildcards.figure,
            chunk=range(study.figures[wildcards.figure].chunks),
        ),
    output:
        data="<results>/data/{figure}.nc",
        record="<results>/data/{figure}.run.json",
    log:
        "<results>/logs/merge/{figure}.log",
    wildcard_constraints:
        figure="|".join(GRIDDED),
    priority: 1
    params:
        *code("merge"),
        sweep=sweep,
        title=title,
    message:
        "{wildcards.figure}: merging its chunks"
    script:
        "../scripts/merge.py"


rule history:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/{figure}.nc",
        record="<results>/data/{figure}.run.json",
    log:
        "<results>/logs/history/{figure}.log",
    wildcard_constraints:
        figure="|".join(HISTORIES),
    params:
        *code("sweep"),
        sweep=sweep,
        title=title,
    message:
        "{wildcards.figure}: computing the trajectory"
    script:
        "../scripts/sweep.py"


rule schematic:
    output:
        multiext("<results>/figures/{figure}", ".svg", ".pdf"),
        png=report(
            "<results>/figures/{figure}.png",
            caption="../report/figure.rst",
            category="Figures of the paper",
        ),
        record="<results>/figures/{figure}.run.json",
    log:
        "<results>/logs/schematic/{figure}.log",
    wildcard_constraints:
        figure="|".join(SCHEMATICS),
    params:
        *code("schematic"),
        parameters=lambda wildcards: study.parameters(wildcards.figure).given(),
    message:
        "{wildcards.figure}: drawing the model"
    script:
        "../scripts/schematic.py"


# For a figure that is a map, the picture shows the refined map with the figure's own points.
rule plot:
    input:
        lambda wildcards: (["<results>/data/maps/{figure}.nc"] if wildcards.figure in MAPS else []),
        "<results>/data/{figure}.nc",
    output:
        multiext("<results>/figures/{figure}", ".svg", ".pdf"),
        png=report(
            "<results>/figures/{figure}.png",
            caption="../report/figure.rst",
            category="Figures of the paper",
        ),
        record="<results>/figures/{figure}.run.json",
    log:
        "<results>/logs/plot/{figure}.log",
    wildcard_constraints:
        figure="|".join(COMPUTED),
    params:
        *code("plot"),
    message:
        "{wildcards.figure}: plotting"
    script:
        "../scripts/plot.py"


# `snakemake -c2 fig06` builds one figure, and its data, which a picture that is there does not ask for.
for name in FIGURES:

    rule:
        name:
            name
        input:
            pictures(f"figures/{name}"),
            f"<results>/data/{name}.nc" if name in COMPUTED else [],
