"""Stability maps that follow their boundary: those of Figs. 13 and 14, and `snakemake -c2 maps`."""

from model.study.map_datasets import marks_of
from model.study.maps import map_plan

WITH_VIBRATION = ("fig13", "friction_press_force")  # of these, what vibration adds is drawn

plan = dict(plan=lambda wildcards: map_plan(study, wildcards.map))

job(
    "map_part",
    dict(data=root / "data/maps/{map}/{chunk}.nc"),
    after_kernels,
    dict(**plan, part=lambda wildcards: int(wildcards.chunk), parts=study.maps.chunks),
    message="map {wildcards.map}: computing part {wildcards.chunk}",
    priority=1,
)

job(
    "map",
    dict(data=root / "data/maps/{map}.nc"),
    dict(parts=expand(root / "data/maps/{{map}}/{n}.nc", n=range(study.maps.chunks))),
    dict(
        **plan,
        title=lambda wildcards: study.plane(wildcards.map).title,
        caption=lambda wildcards: study.plane(wildcards.map).caption,
        marks=lambda wildcards: marks_of(study, wildcards.map),
    ),
    message="map {wildcards.map}: assembling its parts",
    local=True,
)

job(
    "draw_vibration",
    dict(pictures=pictures(root / "figures/maps/{map}_vibration")),
    dict(data=root / "data/maps/{map}.nc"),
    wildcards=dict(map="|".join(WITH_VIBRATION)),
    message="map {wildcards.map}: plotting what vibration adds",
    reported=("Stability maps", "vibration"),
    local=True,
)

job(
    "draw_map",
    dict(pictures=pictures(root / "figures/maps/{map}")),
    dict(data=root / "data/maps/{map}.nc"),
    runs="plot",
    run="plot/{map}",
    message="map {wildcards.map}: plotting",
    reported=("Stability maps", "map"),
    local=True,
)
