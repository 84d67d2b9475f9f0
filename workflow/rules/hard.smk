"""Hard cases: every method on every case, and the two pictures of it."""

from verification.plans import hard_cases_plan


# As in precision.smk: errors and evaluations are data, CPU times stand apart.
rule hard_cases:
    input:
        kernels=root / "data/unlocated_kernels.json",
    output:
        data=root / "data/hard_cases.csv",
        record=root / "data/hard_cases.run.json",
        times=root / "benchmarks/hard_cases.csv",
    log:
        root / "logs/hard_cases.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("judge_hard_cases"),
        plan=hard_cases_plan(study).model_dump_json(),
    message:
        "every method on every hard case"
    shell:
        "python workflow/scripts/judge_hard_cases.py --plan {params.plan:q}"
        " --output {output.data} --times {output.times} --record {output.record} > {log} 2>&1"


for picture, place in HARD_PICTURES.items():

    rule:
        name:
            f"draw_{picture}"
        input:
            root / "data/hard_cases.csv",
        output:
            png=root / f"{place}.png",
            svg=root / f"{place}.svg",
            pdf=root / f"{place}.pdf",
            record=root / f"{place}.run.json",
        log:
            root / f"logs/draw_{picture}.log",
        conda:
            "../envs/study.yaml"
        params:
            code=code("draw_hard_cases"),
            picture=picture,
            spec=study.hard_cases.model_dump_json(),
        message:
            "hard cases: drawing {params.picture}"
        shell:
            "python workflow/scripts/draw_hard_cases.py --picture {params.picture}"
            " --spec {params.spec:q} --output {output.png} --record {output.record}"
            " {input} > {log} 2>&1"
