"""Comparison of methods: speed against error, figures with fixed steps, and hard cases.

Errors and evaluations are data, the same in every build. CPU times are not: they live under
benchmarks/, and nothing under data/ or figures/ is made from them.
"""

from benchmarks.plans import HARD_PICTURES, PICTURES
from benchmarks.plans import fixed_step_plan, hard_cases_plan, precision_plan

# Apart from the other kernels, so that an edit of what only these jobs run reruns no figure.
job(
    "unlocated_kernels",
    dict(data=root / "data/unlocated_kernels.json"),
    after_kernels,
    dict(code=code("unlocated_kernels")),
    message="compiling the kernels without event location",
    priority=3,
)
after_unlocated = dict(after=root / "data/unlocated_kernels.json")

# One job for both outputs, so that the most expensive runs are made once. It has one thread, of
# which Snakemake tells the linear algebra under scipy's Radau: with more, that rounds otherwise.
job(
    "precision",
    dict(data=root / "data/precision.nc", times=root / "benchmarks/precision.csv"),
    after_unlocated,
    dict(plan=precision_plan(study)),
    message="comparing the methods: error, evaluations and CPU time",
    priority=2,
)

job(
    "hard_cases",
    dict(data=root / "data/hard_cases.csv", times=root / "benchmarks/hard_cases.csv"),
    after_unlocated,
    dict(plan=hard_cases_plan(study)),
    message="every method on every hard case",
    priority=2,
)

job(
    "fixed_steps",
    dict(data=root / "data/fixed_steps/{figure}.nc"),
    dict(**after_unlocated, located=root / "data/{figure}.nc"),
    dict(plan=lambda wildcards: fixed_step_plan(study, wildcards.figure)),
    wildcards=dict(figure="|".join(study.precision.fixed_steps.figures)),
    message="{wildcards.figure}: computing it anew with fixed steps",
    priority=2,
)
fixed_steps = expand(
    root / "data/fixed_steps/{figure}.nc", figure=study.precision.fixed_steps.figures
)

drawn_from = {
    "evaluations": [root / "data/precision.nc"],
    "times": [root / "benchmarks/precision.csv"],
    "wrong_points": fixed_steps,
}
for picture, sources in drawn_from.items():
    job(
        f"draw_{picture}",
        dict(pictures=pictures(root / PICTURES[picture])),
        dict(sources=sources),
        dict(
            picture=picture,
            titles={name: case.title for name, case in study.precision.cases.items()},
        ),
        runs="draw_precision",
        message=f"speed against error: drawing {picture}",
        reported=("Methods", "methods"),
        local=True,
    )

for picture, place in HARD_PICTURES.items():
    job(
        f"draw_{picture}",
        dict(pictures=pictures(root / place)),
        dict(judged=root / "data/hard_cases.csv"),
        dict(picture=picture, spec=study.hard_cases),
        runs="draw_hard_cases",
        message=f"hard cases: drawing {picture}",
        reported=("Methods", "hard_cases"),
        local=True,
    )
