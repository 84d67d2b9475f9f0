"""Refined stability maps: Figs. 13 and 14, and the further ones of `snakemake -c2 maps`."""

from model.study.maps.plan import marks_of


rule map_part:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/maps/{map}/{chunk}.nc",
        record="<results>/data/maps/{map}/{chunk}.run.json",
    log:
        "<results>/logs/map_part/{map}/{chunk}.log",
    priority: 1
    params:
        *code("map_part"),
        plan=plan,
        parts=study.maps.chunks,
    message:
        "map {wildcards.map}: computing part {wildcards.chunk}"
    script:
        "../scripts/map_part.py"


# `marks` are the operating points of other figures.
rule map:
    input:
        expand("<results>/data/maps/{{map}}/{n}.nc", n=range(study.maps.chunks)),
    output:
        data="<results>/data/maps/{map}.nc",
        record="<results>/data/maps/{map}.run.json",
    log:
        "<results>/logs/map/{map}.log",
    localrule: True
    params:
        *code("map"),
        plan=plan,
        title=lambda wildcards: study.plane(wildcards.map).title,
        marks=lambda wildcards: marks_of(study, wildcards.map),
    message:
        "map {wildcards.map}: assembling its parts"
    script:
        "../scripts/map.py"
