"""The figures: compiled kernels, chunks of each sweep, one dataset a figure, and its pictures."""

from model.study.sweeps import sweep_of

wording = dict(
    title=lambda wildcards: study.figures[wildcards.figure].title,
    caption=lambda wildcards: study.figures[wildcards.figure].caption,
)
sweep = dict(sweep=lambda wildcards: sweep_of(study, wildcards.figure))


# Compiled once, before the jobs that would otherwise all compile at the same time. Its output holds
# the hash of the kernels' code, and is taken as `ancient` by none of them: Snakemake does not look at
# the params of a job below one that must run, so that an edit of the physics would run this rule only.
job(
    "kernels",
    dict(data=root / "data/kernels.json"),
    params=dict(code=code("kernels")),
    message="compiling the kernels",
    mem_mb=4000,
    priority=3,
)
after_kernels = dict(after=root / "data/kernels.json")

job(
    "chunk",
    dict(data=root / "data/chunks/{figure}/{chunk}.nc"),
    after_kernels,
    dict(
        **sweep,
        chunk=lambda wildcards: int(wildcards.chunk),
        chunks=lambda wildcards: study.figures[wildcards.figure].chunks,
    ),
    message="{wildcards.figure}: computing chunk {wildcards.chunk}",
    priority=1,
)

job(
    "merge",
    dict(data=root / "data/{figure}.nc"),
    dict(
        parts=lambda wildcards: expand(
            root / "data/chunks/{figure}/{chunk}.nc",
            figure=wildcards.figure,
            chunk=range(study.figures[wildcards.figure].chunks),
        )
    ),
    {**sweep, **wording},
    wildcards=dict(figure="|".join(GRIDDED)),
    message="{wildcards.figure}: merging its chunks",
    local=True,
    priority=1,
)

job(
    "history",
    dict(data=root / "data/{figure}.nc"),
    after_kernels,
    {**sweep, **wording},
    wildcards=dict(figure="|".join(HISTORIES)),
    message="{wildcards.figure}: computing the trajectory",
)

job(
    "schematic",
    dict(pictures=pictures(root / "figures/{figure}")),
    params=dict(
        figure=lambda wildcards: wildcards.figure,
        parameters=lambda wildcards: study.parameters(wildcards.figure).given(),
    ),
    wildcards=dict(figure="|".join(SCHEMATICS)),
    message="{wildcards.figure}: drawing the model",
    reported=("Figures of the paper", "figure"),
    local=True,
)

# Of a figure that is a map, the refined map is shown.
job(
    "plot",
    dict(pictures=pictures(root / "figures/{figure}")),
    dict(
        data=lambda wildcards: root
        / ("data/maps" if wildcards.figure in MAPS else "data")
        / f"{wildcards.figure}.nc",
        coarse=lambda wildcards: (
            [root / f"data/{wildcards.figure}.nc"] if wildcards.figure in MAPS else []
        ),
    ),
    wildcards=dict(figure="|".join(COMPUTED)),
    message="{wildcards.figure}: plotting",
    reported=("Figures of the paper", "figure"),
    local=True,
)

# `snakemake -c2 fig06` builds one figure.
for name in FIGURES:

    rule:
        name:
            name
        input:
            pictures(root / f"figures/{name}"),
