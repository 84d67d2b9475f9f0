"""Data of the figures and of jamming: compiled kernels, sweeps, and chunks of large ones, merged."""

# Sweeps that one job computes: trajectories, figures of one chunk, and jamming.
WHOLE = [*HISTORIES, *(name for name in GRIDDED if study.figures[name].chunks == 1), "jamming"]
IN_CHUNKS = [name for name in GRIDDED if name not in WHOLE]


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


rule sweep:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/{name}.nc",
        record="<results>/data/{name}.run.json",
    log:
        "<results>/logs/sweep/{name}.log",
    wildcard_constraints:
        name="|".join(WHOLE),
    priority: 1
    params:
        *code("sweep"),
        sweep=lambda wildcards: stated(sweep_of(study, wildcards.name)),
        title=lambda wildcards: (
            study.jamming if wildcards.name == "jamming" else study.figures[wildcards.name]
        ).title,
    message:
        "{wildcards.name}: computing its sweep"
    script:
        "../scripts/sweep.py"


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
        sweep=figure_sweep,
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
        figure="|".join(IN_CHUNKS),
    priority: 1
    localrule: True
    params:
        *code("merge"),
        sweep=figure_sweep,
        title=lambda wildcards: study.figures[wildcards.figure].title,
    message:
        "{wildcards.figure}: merging its chunks"
    script:
        "../scripts/merge.py"
