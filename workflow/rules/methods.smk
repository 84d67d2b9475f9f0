"""Comparison of methods: error against cost, on usual and on hard cases.

Errors and evaluations are the same in every build. CPU times are not: they are kept in benchmarks/
with the picture that is made from them.
"""

from verification.bench.plans import PICTURE, precision_plan


# One job for both outputs, so that the most expensive runs are made once.
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


rule draw_methods:
    input:
        times="<results>/benchmarks/precision.csv",
    output:
        [f"<results>/{PICTURE}.{kind}" for kind in ("svg", "pdf")],
        png=report(
            f"<results>/{PICTURE}.png",
            caption="../report/methods.rst",
            category="Methods",
        ),
        record="<results>/benchmarks/methods.run.json",
    log:
        "<results>/logs/draw_methods.log",
    localrule: True
    params:
        *code("draw_methods"),
        cases={name: case.title for name, case in study.precision.cases.items()},
    message:
        "drawing the comparison of methods"
    script:
        "../scripts/draw_methods.py"
