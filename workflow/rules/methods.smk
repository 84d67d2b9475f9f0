"""Comparison of methods: speed against error, and hard cases.

Errors and evaluations are the same in every build. CPU times are not: they are kept in benchmarks/,
and nothing in data/ or figures/ is made from them.
"""

from benchmarks.plans import hard_cases_plan, precision_plan

drawn_from = {
    "evaluations": ["<results>/data/precision.csv"],
    "times": ["<results>/benchmarks/precision.csv"],
    **dict.fromkeys(HARD_PICTURES, ["<results>/data/hard_cases.csv"]),
}


# Apart from the other kernels, so that an edit of the compared methods reruns no figure.
rule unlocated_kernels:
    input:
        "<results>/data/kernels.json",
    output:
        data="<results>/data/unlocated_kernels.json",
        record="<results>/data/unlocated_kernels.run.json",
    log:
        "<results>/logs/unlocated_kernels.log",
    priority: 3
    params:
        *code("unlocated_kernels"),
        parameters=study.baseline.given(),
    message:
        "compiling the kernels without event location"
    script:
        "../scripts/unlocated_kernels.py"


# One job for both outputs, so that the most expensive runs are made once. Snakemake limits a job of
# one thread to one thread of linear algebra: with more, scipy's Radau would round otherwise.
rule precision:
    input:
        "<results>/data/unlocated_kernels.json",
    output:
        data="<results>/data/precision.csv",
        times="<results>/benchmarks/precision.csv",
        record="<results>/data/precision.run.json",
    log:
        "<results>/logs/precision.log",
    priority: 2
    params:
        *code("precision"),
        plan=stated(precision_plan(study)),
    message:
        "comparing the methods: error, evaluations and CPU time"
    script:
        "../scripts/precision.py"


rule hard_cases:
    input:
        "<results>/data/unlocated_kernels.json",
    output:
        data="<results>/data/hard_cases.csv",
        times="<results>/benchmarks/hard_cases.csv",
        record="<results>/data/hard_cases.run.json",
    log:
        "<results>/logs/hard_cases.log",
    priority: 2
    params:
        *code("hard_cases"),
        plan=stated(hard_cases_plan(study)),
    message:
        "every method on every hard case"
    script:
        "../scripts/hard_cases.py"


rule draw_methods:
    input:
        lambda wildcards: drawn_from[picture_at(wildcards)],
    output:
        multiext("<results>/{place}", ".svg", ".pdf"),
        png=report("<results>/{place}.png", caption="../report/methods.rst", category="Methods"),
        record="<results>/{place}.run.json",
    log:
        "<results>/logs/draw_methods/{place}.log",
    wildcard_constraints:
        place="|".join([*PICTURES.values(), *HARD_PICTURES.values()]),
    localrule: True
    params:
        *code("draw_methods"),
        picture=picture_at,
        titles={name: case.title for name, case in study.precision.cases.items()},
        hard_cases=stated(study.hard_cases),
    message:
        "methods: drawing {wildcards.place}"
    script:
        "../scripts/draw_methods.py"
