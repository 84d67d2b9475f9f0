"""Verdicts on the study's device under other assumptions than the study's, each by itself."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings
from model.sweeps.sweep import Sweep
from study.claims.claims import CLAIMS
from study.claims.data import Tables
from study.config.evidence import Change
from study.config.identification import Grid
from study.evidence.null import CLAIM, VERDICT, Verdicts, tables_at, verdicts_of
from study.identification.space import Space, own_values, space_of

if TYPE_CHECKING:
    import xarray as xr

    from study.config.study import Study

OWN = "own"  # the study's assumptions


class AssumptionsPlan(Plan):
    """Verdicts by assumption as data.

    Attributes:
        space: makes sweeps of unknowns.
        own: values of the unknowns of the study's device.
        grid: on which the figures are computed.
        assumptions: by name, the study's own first.
    """

    space: Space
    own: dict[str, float]
    grid: Grid
    assumptions: dict[str, Change]


def assumptions_plan(study: "Study") -> AssumptionsPlan:
    """Return the plan of the verdicts by assumption."""
    spec, space = study.evidence, space_of(study)
    changes = {
        name: Change(**each.model_dump(exclude={"title"}))
        for name, each in spec.assumptions.items()
    }
    own = own_values(study, space)
    return AssumptionsPlan(
        space=space, own=own, grid=spec.grid, assumptions={OWN: Change(), **changes}
    )


def verdicts_under(plan: AssumptionsPlan, assumption: Change) -> Verdicts:
    """Return the verdicts under an assumption, shape (claims,)."""

    def changed(sweep: Sweep) -> Sweep:
        settings = RunSettings.model_validate(sweep.settings.model_dump() | assumption.settings)
        parameters = sweep.parameters | assumption.held
        return sweep.model_copy(update={"settings": settings, "parameters": parameters})

    tables = tables_at(plan.space, [plan.own], plan.grid, changed)
    return verdicts_of(_going_in(tables) if assumption.inserted else tables, 1)[0]


def _going_in(tables: Tables) -> Tables:
    """Return tables in which a part that does not go in does not align."""
    return Tables(
        {
            name: table.assign(
                aligned=table["goes_in"],
                stays=table["goes_in"],
                tau=table["tau"].where(table["goes_in"]),
            )
            for name, table in tables.frames.items()
        }
    )


def assumptions_dataset(plan: AssumptionsPlan, titles: Mapping[str, str]) -> "xr.Dataset":
    """Return the verdicts under every assumption, over (assumption, claim), with its words."""
    import xarray as xr  # noqa: PLC0415  (slow)

    verdicts = [verdicts_under(plan, each) for each in plan.assumptions.values()]
    words = [titles.get(name, "as the study assumes") for name in plan.assumptions]
    return xr.Dataset(
        {
            "verdict": (("assumption", "claim"), np.array(verdicts), VERDICT),
            "title": ("assumption", words, {"long_name": "the assumption in words"}),
        },
        {
            "assumption": (
                "assumption", [*plan.assumptions], {"long_name": "assumption, by its name"},
            ),
            "claim": ("claim", [claim.id for claim in CLAIMS], CLAIM),
        },
        {
            "title": "Verdicts by assumption",
            "summary": "Verdicts on the claims for the device of the study under other assumptions "
            "than the study's, each by itself.",
            "figure": "assumptions",
            "config_hash": plan.identity,
        },
    )  # fmt: skip
