"""Refined stability maps: Figs. 13 and 14, and the further ones of `snakemake -c2 maps`."""

from model.study.maps.plan import marks_of


localrules:
    map,
    draw_map,
    draw_vibration,


WITH_VIBRATION = ("fig13", "friction_press_force")  # maps with a picture of what vibration adds


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
    params:
        *code("map"),
        plan=plan,
        title=lambda wildcards: study.plane(wildcards.map).title,
        marks=lambda wildcards: marks_of(study, wildcards.map),
    message:
        "map {wildcards.map}: assembling its parts"
    script:
        "../scripts/map.py"


rule draw_map:
    input:
        "<results>/data/maps/{map}.nc",
    output:
        multiext("<results>/figures/maps/{map}", ".svg", ".pdf"),
        png=report(
            "<results>/figures/maps/{map}.png",
            caption="../report/map.rst",
            category="Stability maps",
        ),
        record="<results>/figures/maps/{map}.run.json",
    log:
        "<results>/logs/draw_map/{map}.log",
    params:
        *code("plot"),
    message:
        "map {wildcards.map}: plotting"
    script:
        "../scripts/plot.py"


rule draw_vibration:
    input:
        "<results>/data/maps/{map}.nc",
    output:
        multiext("<results>/figures/maps/{map}_vibration", ".svg", ".pdf"),
        png=report(
            "<results>/figures/maps/{map}_vibration.png",
            caption="../report/vibration.rst",
            category="Stability maps",
        ),
        record="<results>/figures/maps/{map}_vibration.run.json",
    log:
        "<results>/logs/draw_vibration/{map}.log",
    wildcard_constraints:
        map="|".join(WITH_VIBRATION),
    params:
        *code("draw_vibration"),
    message:
        "map {wildcards.map}: plotting what vibration adds"
    script:
        "../scripts/draw_vibration.py"


# All maps that are no figures of the paper; maps that are figures belong to the study.
rule maps:
    input:
        pictures(*(f"figures/maps/{map}" for map in study.map_names if map not in MAPS)),
        pictures(*(f"figures/maps/{map}_vibration" for map in WITH_VIBRATION)),
