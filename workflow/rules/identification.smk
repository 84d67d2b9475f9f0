"""The searches for the parameters that the paper leaves unstated: `make identification`."""

from study.identification.space import space_of


rule search:
    input:
        "<results>/data/kernels.json",
    output:
        found="<results>/identification/{search}.yaml",
        record="<results>/identification/{search}.run.json",
    log:
        "<results>/logs/search/{search}.log",
    wildcard_constraints:
        search="|".join(study.identification.searches),
    params:
        *code("search"),
        space=stated(space_of(study)),
        effort=lambda wildcards: stated(study.identification.searches[wildcards.search]),
    message:
        "search: {wildcards.search}"
    script:
        "../scripts/search.py"


rule identification:
    input:
        expand("<results>/identification/{search}.yaml", search=study.identification.searches),
    localrule: True
