"""The claims ledger: the paper's claims, judged by the figures' data, by more runs; jamming."""

from model.study.jamming import jamming_sweep
from model.study.sweeps import claim_sweep

claims_data = expand(root / "data/claims/{run}.nc", run=study.claims_runs)

job(
    "claims_runs",
    dict(data=claims_data),
    after_kernels,
    dict(
        sweeps={name: claim_sweep(study, name) for name in study.claims_runs},
        titles={name: run.title for name, run in study.claims_runs.items()},
    ),
    record=root / "data/claims/runs.run.json",
    message="computing the runs that only the claims ledger needs",
)

job(
    "claims",
    dict(table=root / "claims.csv"),
    dict(figures=expand(root / "data/{figure}.nc", figure=COMPUTED), runs=claims_data),
    message="judging the claims of the paper",
    reported=("Claims", "claims"),
    local=True,
)

job(
    "draw_claims",
    dict(pictures=pictures(root / "figures/claims")),
    dict(data=claims_data),
    message="drawing the runs that only the claims ledger needs",
    reported=("Claims", "claims_runs"),
    local=True,
)

job(
    "jamming",
    dict(data=root / "data/jamming.nc"),
    after_kernels,
    dict(sweep=jamming_sweep(study), title=study.jamming.title),
    message="following parts into the slot",
)

job(
    "draw_jamming",
    dict(pictures=pictures(root / "figures/jamming")),
    dict(data=root / "data/jamming.nc"),
    message="drawing jamming in the slot",
    reported=("Claims", "jamming"),
    local=True,
)
