"""What the base's stiffness and damping change: three figures on coarse grids and other bases."""

from model.study.contact_stiffness import stiffness_plan

contact_data = expand(
    root / "data/contact_stiffness/{figure}.nc", figure=study.contact_stiffness.figures
)


rule contact_stiffness:
    input:
        kernels=root / "data/kernels.json",
    output:
        data=root / "data/contact_stiffness/{figure}.nc",
        record=root / "data/contact_stiffness/{figure}.run.json",
    log:
        root / "logs/contact_stiffness/{figure}.log",
    wildcard_constraints:
        figure="|".join(study.contact_stiffness.figures),
    conda:
        "../envs/study.yaml"
    params:
        code=code("vary_contact"),
        plan=lambda wildcards: stiffness_plan(study, wildcards.figure).model_dump_json(),
        label=lambda wildcards: label(wildcards.figure),
    message:
        "{wildcards.figure}: computing it on other bases"
    shell:
        "python workflow/scripts/vary_contact.py --plan {params.plan:q}"
        " --title {params.label[title]:q} --output {output.data} --record {output.record} > {log} 2>&1"


rule draw_contact:
    input:
        contact_data,
    output:
        png=root / "figures/contact_stiffness.png",
        svg=root / "figures/contact_stiffness.svg",
        pdf=root / "figures/contact_stiffness.pdf",
        record=root / "figures/contact_stiffness.run.json",
    log:
        root / "logs/draw_contact.log",
    conda:
        "../envs/study.yaml"
    params:
        code=code("draw_contact"),
    message:
        "drawing what the base changes"
    shell:
        "python workflow/scripts/draw_contact.py --output {output.png}"
        " --record {output.record} {input} > {log} 2>&1"
