"""Stability maps that follow their boundary: those of Figs. 13 and 14, and `snakemake -c2 maps`."""

from model.study.config import LARGEST_MISALIGNMENT
from model.study.largest_misalignment import limit_plan
from model.study.map_datasets import marks_of
from model.study.maps import map_plan

outcome_maps = [name for name in study.map_names if name != LARGEST_MISALIGNMENT]
part = dict(part=lambda wildcards: int(wildcards.chunk), parts=study.maps.chunks)
plane = dict(
    title=lambda wildcards: study.plane(wildcards.map).title,
    caption=lambda wildcards: study.plane(wildcards.map).caption,
)


def map_rules(part_job, map_job, names, plan, **params):
    """Define the rules of the maps ``names``: of their parts, and of the whole."""
    job(
        part_job,
        dict(data=root / "data/maps/{map}/{chunk}.nc"),
        after_kernels,
        {**plan, **part},
        wildcards=dict(map="|".join(names)),
        message="map {wildcards.map}: computing part {wildcards.chunk}",
    )
    job(
        map_job,
        dict(data=root / "data/maps/{map}.nc"),
        dict(parts=expand(root / "data/maps/{{map}}/{n}.nc", n=range(study.maps.chunks))),
        {**plan, **plane, **params},
        wildcards=dict(map="|".join(names)),
        message="map {wildcards.map}: assembling its parts",
    )


map_rules(
    "map_part",
    "map",
    outcome_maps,
    dict(plan=lambda wildcards: map_plan(study, wildcards.map)),
    marks=lambda wildcards: marks_of(study, wildcards.map),
)
map_rules("limit_part", "limit", [LARGEST_MISALIGNMENT], dict(plan=limit_plan(study)))

job(
    "draw_map",
    dict(pictures=pictures(root / "figures/maps/{map}")),
    dict(data=root / "data/maps/{map}.nc"),
    runs="plot",
    run="plot/{map}",
    message="map {wildcards.map}: plotting",
)
