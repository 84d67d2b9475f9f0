"""Comparison of methods: error against cost, on usual and on hard cases.

Errors and evaluations are the same in every build. CPU times are not: they are kept in benchmarks/,
and nothing in data/ or figures/ is made from them.
"""

from verification.bench.plans import precision_plan


# One job for both outputs, so that the most expensive runs are made once. Snakemake limits a job of
# one thread to one thread of linear algebra: with more, scipy's Radau would round otherwise.
rule precision:
    input:
        "<results>/data/kernels.json",
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


# One job for both pictures, because a start of Python costs more than drawing them.
rule draw_methods:
    input:
        data="<results>/data/precision.csv",
        times="<results>/benchmarks/precision.csv",
    output:
        [f"<results>/{place}.{kind}" for place in PICTURES.values() for kind in ("svg", "pdf")],
        png=report(
            [f"<results>/{place}.png" for place in PICTURES.values()],
            caption="../report/methods.rst",
            category="Methods",
        ),
        record="<results>/figures/methods.run.json",
    log:
        "<results>/logs/draw_methods.log",
    localrule: True
    params:
        *code("draw_methods"),
        cases={name: case.title for name, case in study.precision.cases.items()},
    message:
        "methods: drawing their comparison"
    script:
        "../scripts/draw_methods.py"
