"""The search for the parameters that the paper leaves unstated: `make identification`, `make hold-out`.

A further entry in `rounds` goes on where the search has ended. The parts are kept: they take hours.
"""

from study.identification.space import space_of

search = study.identification
space = stated(space_of(study))
halves = search.hold_out.halves
SCORED = expand("<results>/identification/final/{number}.json", number=range(search.final.sets))


rule search_pool:
    input:
        "<results>/data/kernels.json",
    output:
        sets="<results>/identification/pool/{part}.csv",
        record="<results>/identification/pool/{part}.run.json",
    log:
        "<results>/logs/search_pool/{part}.log",
    params:
        *code("search_pool"),
        space=space,
        structures=search.pool.structures,
        stages=[stated(stage) for stage in search.pool.stages],
    message:
        "search: drawing part {wildcards.part} of the pool"
    script:
        "../scripts/search_pool.py"


rule search_round:
    input:
        sets_before,
    output:
        sets="<results>/identification/{start}/{round}.csv",
        record="<results>/identification/{start}/{round}.run.json",
    log:
        "<results>/logs/search_round/{start}/{round}.log",
    wildcard_constraints:
        start=r"\d+",
        round=r"\d+",
    params:
        *code("search_round"),
        space=space,
        round=lambda wildcards: stated(search.rounds[int(wildcards.round)]),
    message:
        "search from start {wildcards.start}: round {wildcards.round}"
    script:
        "../scripts/search_round.py"


rule search_final:
    input:
        expand(
            "<results>/identification/{start}/{round}.csv",
            start=search.starts,
            round=len(search.rounds) - 1,
        ),
    output:
        scored="<results>/identification/final/{number}.json",
        record="<results>/identification/final/{number}.run.json",
    log:
        "<results>/logs/search_final/{number}.log",
    params:
        *code("search_final"),
        space=space,
        stages=[stated(stage) for stage in search.final.stages],
    message:
        "search: scoring set {wildcards.number} on the study's own grids"
    script:
        "../scripts/search_final.py"


rule search_polish:
    input:
        SCORED,
    output:
        scored="<results>/identification/polished/{number}.json",
        record="<results>/identification/polished/{number}.run.json",
    log:
        "<results>/logs/search_polish/{number}.log",
    params:
        *code("search_polish"),
        space=space,
        trials=search.polish.trials,
        stages=[stated(stage) for stage in search.polish.stages],
    message:
        "search: small steps from set {wildcards.number}"
    script:
        "../scripts/search_polish.py"


rule search_summary:
    input:
        SCORED,
        expand("<results>/identification/polished/{number}.json", number=range(search.polish.sets)),
    output:
        sets="<results>/identification/sets.csv",
        ranges="<results>/identification/ranges.csv",
        claims="<results>/identification/claims.csv",
        device="<results>/identification/device.yaml",
        record="<results>/identification/summary.run.json",
    log:
        "<results>/logs/search_summary.log",
    localrule: True
    params:
        *code("search_summary"),
        space=space,
    message:
        "search: the sets that were found, and the device"
    script:
        "../scripts/search_summary.py"


rule hold_out_half:
    input:
        "<results>/data/kernels.json",
    output:
        devices="<results>/identification/hold_out/{unseen}.csv",
        record="<results>/identification/hold_out/{unseen}.run.json",
    log:
        "<results>/logs/hold_out_half/{unseen}.log",
    params:
        *code("hold_out_half"),
        seen=lambda wildcards: stated(space_of(study, figures_without(wildcards.unseen))),
        unseen=lambda wildcards: stated(space_of(study, halves[wildcards.unseen])),
        effort=stated(search.hold_out),
    message:
        "hold-out: searching without the {wildcards.unseen} figures"
    script:
        "../scripts/hold_out_half.py"


rule hold_out_summary:
    input:
        **{half: f"<results>/identification/hold_out/{half}.csv" for half in halves},
    output:
        counts="<results>/identification/hold_out.csv",
        claims="<results>/identification/hold_out_claims.csv",
        record="<results>/identification/hold_out.run.json",
    log:
        "<results>/logs/hold_out_summary.log",
    localrule: True
    params:
        *code("hold_out_summary"),
    message:
        "hold-out: what was predicted, and what only fitted"
    script:
        "../scripts/hold_out_summary.py"
