"""Trajectories: compiled kernels, chunks of each figure's sweep, and one dataset a figure."""


# Compiled once, before the jobs that would otherwise all compile at the same time. Its output holds
# the hash of the kernels' code, and is taken as `ancient` by none of them: Snakemake does not look at
# the params of a job below one that must run, so that an edit of the physics would run this rule only.
rule kernels:
    output:
        data=root / "data/kernels.json",
        record=root / "data/kernels.run.json",
    log:
        root / "logs/kernels.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compile_kernels"),
    message:
        "compiling the kernels"
    shell:
        "python workflow/scripts/compile_kernels.py --output {output.data}"
        " --record {output.record} > {log} 2>&1"


rule chunk:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / "data/chunks/{figure}/{chunk}.nc",
        record=root / "data/chunks/{figure}/{chunk}.run.json",
    log:
        root / "logs/chunk/{figure}/{chunk}.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compute_chunk"),
        sweep=lambda wildcards: sweep(wildcards.figure),
        chunks=lambda wildcards: study.figures[wildcards.figure].chunks,
    message:
        "{wildcards.figure}: computing chunk {wildcards.chunk} ({params.chunks} in all, from 0)"
    shell:
        "python workflow/scripts/compute_chunk.py --sweep {params.sweep:q}"
        " --chunk {wildcards.chunk} --chunks {params.chunks}"
        " --output {output.data} --record {output.record} > {log} 2>&1"


rule merge:
    input:
        lambda wildcards: expand(
            root / "data/chunks/{figure}/{chunk}.nc",
            figure=wildcards.figure,
            chunk=range(study.figures[wildcards.figure].chunks),
        ),
    output:
        data=root / "data/{figure}.nc",
        record=root / "data/{figure}.run.json",
    log:
        root / "logs/merge/{figure}.log",
    wildcard_constraints:
        figure="|".join(gridded),
    conda:
        "../envs/study.yaml"
    params:
        code=code("merge_chunks"),
        sweep=lambda wildcards: sweep(wildcards.figure),
        label=lambda wildcards: label(wildcards.figure),
    message:
        "{wildcards.figure}: merging its chunks"
    shell:
        "python workflow/scripts/merge_chunks.py --sweep {params.sweep:q}"
        " --title {params.label[title]:q} --summary {params.label[summary]:q}"
        " --output {output.data} --record {output.record} {input} > {log} 2>&1"


rule history:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / "data/{figure}.nc",
        record=root / "data/{figure}.run.json",
    log:
        root / "logs/history/{figure}.log",
    wildcard_constraints:
        figure="|".join(HISTORIES),
    conda:
        "../envs/study.yaml"
    params:
        code=code("compute_history"),
        sweep=lambda wildcards: sweep(wildcards.figure),
        label=lambda wildcards: label(wildcards.figure),
    message:
        "{wildcards.figure}: computing the trajectory"
    shell:
        "python workflow/scripts/compute_history.py --sweep {params.sweep:q}"
        " --title {params.label[title]:q} --summary {params.label[summary]:q}"
        " --output {output.data} --record {output.record} > {log} 2>&1"
