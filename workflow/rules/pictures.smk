"""Pictures: schematics, and one picture or more of each dataset."""

WITH_VIBRATION = ("fig13", "friction_press_force")  # maps with a picture of what vibration adds

# Data, drawing and category of the report, by the picture.
PLOTTED = {
    **{name: (name, "figure", "Figures of the paper") for name in study.computed},
    **{name: (name, "figure", "Stability maps") for name in PLANES},
    **{f"{name}_vibration": (name, "vibration", "Stability maps") for name in WITH_VIBRATION},
    "jamming": ("jamming", "jamming", "Claims"),
}


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
        figure="|".join(study.named("schematic")),
    localrule: True
    params:
        *code("schematic"),
        parameters=lambda wildcards: study.parameters(wildcards.figure).given(),
    message:
        "{wildcards.figure}: drawing the model"
    script:
        "../scripts/schematic.py"


rule plot:
    input:
        lambda wildcards: f"<results>/data/{PLOTTED[wildcards.picture][0]}.nc",
    output:
        multiext("<results>/figures/{picture}", ".svg", ".pdf"),
        png=report(
            "<results>/figures/{picture}.png",
            caption="../report/picture.rst",
            category=lambda wildcards: PLOTTED[wildcards.picture][2],
        ),
        record="<results>/figures/{picture}.run.json",
    log:
        "<results>/logs/plot/{picture}.log",
    wildcard_constraints:
        picture="|".join(PLOTTED),
    localrule: True
    params:
        *code("plot"),
        drawing=lambda wildcards: PLOTTED[wildcards.picture][1],
    message:
        "{wildcards.picture}: plotting"
    script:
        "../scripts/plot.py"


# `snakemake -c2 fig06` builds one figure, and its data, which a picture that is there does not ask for.
for name in study.figures:

    rule:
        name:
            name
        input:
            pictures(f"figures/{name}"),
            f"<results>/data/{name}.nc" if name in study.computed else [],


# `snakemake -c2 maps` builds the maps that are no figures of the paper.
rule maps:
    input:
        pictures(*(f"figures/{name}" for name in PLANES)),
        pictures(*(f"figures/{name}_vibration" for name in WITH_VIBRATION)),
