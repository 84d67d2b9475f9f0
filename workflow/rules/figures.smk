"""Data of figures, maps and jamming: compiled kernels, sweeps, and chunks of large ones, merged."""

PLANES = [*study.maps.planes]  # maps that are no figures
# Sweeps that one job computes: trajectories, figures of one chunk, and jamming.
IN_CHUNKS = [
    name for name in (*study.named("curves", "map"), *PLANES) if study.spec_of(name).chunks > 1
]
WHOLE = [name for name in (*study.computed, *PLANES, "jamming") if name not in IN_CHUNKS]


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
        sweep=sweep,
    message:
        "{wildcards.name}: computing its sweep"
    script:
        "../scripts/sweep.py"


rule chunk:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/chunks/{name}/{chunk}.nc",
        record="<results>/data/chunks/{name}/{chunk}.run.json",
    log:
        "<results>/logs/chunk/{name}/{chunk}.log",
    priority: 1
    params:
        *code("chunk"),
        sweep=sweep,
        chunks=chunks,
    message:
        "{wildcards.name}: computing chunk {wildcards.chunk}"
    script:
        "../scripts/chunk.py"


rule merge:
    input:
        lambda wildcards: expand(
            "<results>/data/chunks/{name}/{chunk}.nc",
            name=wildcards.name,
            chunk=range(chunks(wildcards)),
        ),
    output:
        data="<results>/data/{name}.nc",
        record="<results>/data/{name}.run.json",
    log:
        "<results>/logs/merge/{name}.log",
    wildcard_constraints:
        name="|".join(IN_CHUNKS or ["-"]),  # an empty one would match every name
    priority: 1
    localrule: True
    params:
        *code("merge"),
        sweep=sweep,
    message:
        "{wildcards.name}: merging its chunks"
    script:
        "../scripts/merge.py"
