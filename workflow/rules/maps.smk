"""Stability maps that follow their boundary: those of Figs. 13 and 14, and `snakemake -c2 maps`."""

import json

from model.study.config import LARGEST_MISALIGNMENT
from model.study.largest_misalignment import limit_plan
from model.study.map_datasets import marks_of
from model.study.maps import map_plan

outcome_maps = [name for name in study.map_names if name != LARGEST_MISALIGNMENT]


rule map_part:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / "data/maps/{map}/{chunk}.nc",
        record=root / "data/maps/{map}/{chunk}.run.json",
    log:
        root / "logs/map_part/{map}/{chunk}.log",
    wildcard_constraints:
        map="|".join(outcome_maps),
    conda:
        "../envs/study.yaml"
    params:
        code=code("compute_map_part"),
        plan=lambda wildcards: map_plan(study, wildcards.map).model_dump_json(),
        parts=study.maps.chunks,
    message:
        "map {wildcards.map}: computing part {wildcards.chunk} ({params.parts} in all, from 0)"
    shell:
        "python workflow/scripts/compute_map_part.py --plan {params.plan:q}"
        " --part {wildcards.chunk} --parts {params.parts}"
        " --output {output.data} --record {output.record} > {log} 2>&1"


rule map:
    input:
        expand(root / "data/maps/{{map}}/{chunk}.nc", chunk=range(study.maps.chunks)),
    output:
        data=root / "data/maps/{map}.nc",
        record=root / "data/maps/{map}.run.json",
    log:
        root / "logs/map/{map}.log",
    wildcard_constraints:
        map="|".join(outcome_maps),
    conda:
        "../envs/study.yaml"
    params:
        code=code("assemble_map"),
        plan=lambda wildcards: map_plan(study, wildcards.map).model_dump_json(),
        plane=lambda wildcards: study.plane(wildcards.map),
        marks=lambda wildcards: json.dumps(marks_of(study, wildcards.map)),
    message:
        "map {wildcards.map}: assembling its parts"
    shell:
        "python workflow/scripts/assemble_map.py --plan {params.plan:q}"
        " --title {params.plane.title:q} --summary {params.plane.sees:q} --marks {params.marks:q}"
        " --output {output.data} --record {output.record} {input} > {log} 2>&1"


rule limit_part:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / f"data/maps/{LARGEST_MISALIGNMENT}/{{chunk}}.nc",
        record=root / f"data/maps/{LARGEST_MISALIGNMENT}/{{chunk}}.run.json",
    log:
        root / f"logs/limit_part/{LARGEST_MISALIGNMENT}/{{chunk}}.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compute_limit_part"),
        plan=limit_plan(study).model_dump_json(),
        parts=study.maps.chunks,
    message:
        "largest misalignment: computing part {wildcards.chunk} ({params.parts} in all, from 0)"
    shell:
        "python workflow/scripts/compute_limit_part.py --plan {params.plan:q}"
        " --part {wildcards.chunk} --parts {params.parts}"
        " --output {output.data} --record {output.record} > {log} 2>&1"


rule limit:
    input:
        expand(
            root / f"data/maps/{LARGEST_MISALIGNMENT}/{{chunk}}.nc",
            chunk=range(study.maps.chunks),
        ),
    output:
        data=root / f"data/maps/{LARGEST_MISALIGNMENT}.nc",
        record=root / f"data/maps/{LARGEST_MISALIGNMENT}.run.json",
    log:
        root / f"logs/limit/{LARGEST_MISALIGNMENT}.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("assemble_limit"),
        plan=limit_plan(study).model_dump_json(),
        plane=study.maps.largest_misalignment,
    message:
        "largest misalignment: assembling its parts"
    shell:
        "python workflow/scripts/assemble_limit.py --plan {params.plan:q}"
        " --title {params.plane.title:q} --summary {params.plane.sees:q}"
        " --output {output.data} --record {output.record} {input} > {log} 2>&1"


rule draw_map:
    input:
        root / "data/maps/{map}.nc",
    output:
        png=root / "figures/maps/{map}.png",
        svg=root / "figures/maps/{map}.svg",
        pdf=root / "figures/maps/{map}.pdf",
        record=root / "figures/maps/{map}.run.json",
    log:
        root / "logs/plot/{map}.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_plot"),
    message:
        "map {wildcards.map}: plotting"
    shell:
        "python workflow/scripts/draw_plot.py --output {output.png}"
        " --record {output.record} {input} > {log} 2>&1"


# Every map that is not a figure of the paper: those are part of the study.
rule maps:
    input:
        expand(
            root / "figures/maps/{map}.{kind}",
            map=[name for name in study.map_names if name not in MAPS],
            kind=["png", "svg", "pdf"],
        ),
