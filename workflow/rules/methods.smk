"""Error against cost, on usual and on hard cases.

Errors and evaluations are the same in every build. CPU times are not: they are kept in benchmarks/.
"""

from verification.bench.plans import precision_plan


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
        "measuring error, evaluations and CPU time"
    script:
        "../scripts/precision.py"
