"""The report, one page on the whole study, and the explorer."""

IF_ROUND = [name for name in PLANES if study.spec_of(name).shape == "round"]  # beside the figures
shown = [
    *(f"figures/{figure}" for figure in sorted(study.figures)),
    "figures/jamming",
    *(f"figures/{map}_vibration" for map in WITH_VIBRATION if map in study.named("map")),
    *(f"figures/{name}" for name in IF_ROUND),
]


# The engines as WebAssembly, in the cache; the explorer contains them.
rule page_engines:
    output:
        data="<results>/data/page_engines.json",
        record="<results>/data/page_engines.run.json",
    log:
        "<results>/logs/page_engines.log",
    priority: 3  # beside the other kernels
    params:
        *code("page_engines"),
    message:
        "compiling the engine for the explorer"
    script:
        "../scripts/page_engines.py"


rule explorer:
    input:
        "<results>/data/page_engines.json",
    output:
        page=report(
            "<results>/explorer.html",
            caption="../report/explorer.rst",
            category="The whole study on one page",
        ),
        record="<results>/explorer.run.json",
    log:
        "<results>/logs/explorer.log",
    localrule: True
    params:
        *code("explorer"),
        study=stated(study),
    message:
        "making the explorer"
    script:
        "../scripts/explorer.py"


# The report shows PNGs, and links to the other formats and to the explorer.
rule report:
    input:
        "<results>/explorer.html",
        pictures(*shown),
        expand("<results>/data/{figure}.nc", figure=study.computed),
        "<results>/benchmarks/precision.csv",
        expand("<results>/data/{map}.nc", map=IF_ROUND),
        "<results>/data/jamming.nc",
        "<results>/data/cases.nc",
        "<results>/claims.csv",
    output:
        page=report(
            "<results>/report.html",
            caption="../report/page.rst",
            category="The whole study on one page",
        ),
        record="<results>/report.run.json",
    log:
        "<results>/logs/report.log",
    localrule: True
    params:
        *code("report"),
        study=stated(study),
    message:
        "rendering the report"
    script:
        "../scripts/report.py"
