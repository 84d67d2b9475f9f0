"""Speed against error: all methods on one case of each kind of motion, and fixed steps gone wrong.

Errors and evaluations are data, the same in every build. CPU times are not: they live under
benchmarks/, and nothing under data/ or figures/ is made from them.
"""

import json

from verification.plans import fixed_step_plan, precision_plan


# Apart from the other kernels, so that an edit of what only this section runs reruns no figure.
rule unlocated_kernels:
    input:
        root / "data/kernels.json",
    output:
        data=root / "data/unlocated_kernels.json",
        record=root / "data/unlocated_kernels.run.json",
    log:
        root / "logs/unlocated_kernels.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compile_unlocated"),
    message:
        "compiling the kernels without located switches"
    shell:
        "python workflow/scripts/compile_unlocated.py --output {output.data}"
        " --record {output.record} > {log} 2>&1"


# One job for both outputs, so that the most expensive runs are made once. It has one thread, of
# which Snakemake tells the linear algebra under scipy's Radau: with more, that rounds otherwise.
rule precision:
    input:
        kernels=root / "data/unlocated_kernels.json",
    output:
        data=root / "data/precision.nc",
        record=root / "data/precision.run.json",
        times=root / "benchmarks/precision.csv",
    log:
        root / "logs/precision.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("compare_methods"),
        plan=precision_plan(study).model_dump_json(),
    message:
        "comparing the methods: error, evaluations and CPU time"
    shell:
        "python workflow/scripts/compare_methods.py --plan {params.plan:q} --output {output.data}"
        " --times {output.times} --record {output.record} > {log} 2>&1"


rule fixed_steps:
    input:
        kernels=root / "data/unlocated_kernels.json",
        located=root / "data/{figure}.nc",
    output:
        data=root / "data/fixed_steps/{figure}.nc",
        record=root / "data/fixed_steps/{figure}.run.json",
    log:
        root / "logs/fixed_steps/{figure}.log",
    wildcard_constraints:
        figure="|".join(study.precision.fixed_steps.figures),
    conda:
        "../envs/study.yaml"
    params:
        code=code("take_fixed_steps"),
        plan=lambda wildcards: fixed_step_plan(study, wildcards.figure).model_dump_json(),
    message:
        "{wildcards.figure}: computing it anew with fixed steps"
    shell:
        "python workflow/scripts/take_fixed_steps.py --plan {params.plan:q}"
        " --output {output.data} --record {output.record} {input.located} > {log} 2>&1"


drawn_from = {
    "evaluations": root / "data/precision.nc",
    "times": root / "benchmarks/precision.csv",
    "wrong_points": expand(
        root / "data/fixed_steps/{figure}.nc", figure=study.precision.fixed_steps.figures
    ),
}
for picture, sources in drawn_from.items():

    rule:
        name:
            f"draw_{picture}"
        input:
            sources,
        output:
            png=root / f"{PICTURES[picture]}.png",
            svg=root / f"{PICTURES[picture]}.svg",
            pdf=root / f"{PICTURES[picture]}.pdf",
            record=root / f"{PICTURES[picture]}.run.json",
        log:
            root / f"logs/draw_{picture}.log",
        conda:
            "../envs/study.yaml"
        params:
            code=code("draw_precision"),
            picture=picture,
            titles=json.dumps({name: case.title for name, case in study.precision.cases.items()}),
        message:
            "speed against error: drawing {params.picture}"
        shell:
            "python workflow/scripts/draw_precision.py --picture {params.picture}"
            " --titles {params.titles:q} --output {output.png} --record {output.record}"
            " {input} > {log} 2>&1"
