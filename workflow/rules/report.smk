"""One page of everything, and the index of all runs."""

page_pictures = [
    *(root / f"figures/{figure}" for figure in FIGURES),
    *(root / place for place in (*PICTURES.values(), *HARD_PICTURES.values())),
    *(root / f"figures/{name}" for name in ("claims", "jamming")),
    *(root / f"figures/maps/{map}_vibration" for map in WITH_VIBRATION if map in MAPS),
]
page_data = [
    *expand(root / "data/{figure}.nc", figure=COMPUTED),
    *expand(root / "data/maps/{map}.nc", map=MAPS),
    *fixed_steps,
    *expand(root / "benchmarks/{each}.csv", each=["precision", "hard_cases"]),
    root / "data/jamming.nc",
    root / "claims.csv",
]
page_files = [*page_data, *(pictures(place) for place in page_pictures)]

# The engines as WebAssembly, and the page that runs them, with the two maps to begin with.
job(
    "page_engines",
    dict(stated=root / "data/page_engines.json"),
    message="compiling the engines for the explorer",
    minutes=10,
    priority=3,  # beside the other kernels
)
job(
    "explorer",
    dict(page=root / "explorer.html"),
    dict(
        after=root / "data/page_engines.json",
        maps=expand(root / "data/{map}.nc", map=MAPS),
        refined=expand(root / "data/maps/{map}.nc", map=MAPS),
    ),
    dict(study=study),
    message="making the explorer",
    reported=("The whole study on one page", "explorer"),
    local=True,
)

# The report shows the PNGs, and links to the other kinds of picture and to the explorer.
job(
    "report",
    dict(page=root / "report.html"),
    dict(
        after=[root / "explorer.html", *(pictures(place)[1:] for place in page_pictures)],
        files=[*page_data, *(f"{place}.png" for place in page_pictures)],
    ),
    dict(study=study, root=str(root)),
    message="rendering the report",
    reported=("The whole study on one page", "page"),
    local=True,
)

# Snakemake's handlers write the index anew when an invocation ends, so that one of a single figure,
# and one that failed, is in it as well.
job(
    "index",
    dict(table=root / "runs.csv"),
    dict(after=root / "report.run.json"),
    record="",
    message="indexing all runs",
    local=True,
)


# Every map that is not a figure of the paper: those are part of the study.
rule maps:
    input:
        [pictures(root / f"figures/maps/{map}") for map in study.map_names if map not in MAPS],
        [pictures(root / f"figures/maps/{map}_vibration") for map in WITH_VIBRATION],
