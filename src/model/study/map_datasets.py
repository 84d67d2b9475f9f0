"""Stability maps on disk, as gridded datasets."""

import json
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
import xarray as xr

from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS
from model.physics.quantities import TIME
from model.physics.units import UNITS, Units
from model.study.config import CURVES, HISTORIES, Curves, Study
from model.study.datasets import VARIABLES, global_attributes, parameter_attributes
from model.study.maps import BESIDE, PERIODS, SHARE, MapPlan, StabilityMap, Work

_NO_YES = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "no yes"}

MAP_VARIABLES: dict[str, dict[str, Any]] = {
    "outcome": VARIABLES["outcome"],
    "reason": VARIABLES["reason"],
    "tau_align": {
        "long_name": "alignment duration",
        "symbol": "τ",
        "comment": f"between computed nodes interpolated, within about {PERIODS:g} excitation "
        f"periods or {SHARE:g} of the duration, whichever is more",
    },
    "tau_error": {"long_name": "estimated error of the alignment duration, where computed"},
    "sensitive": {
        "long_name": "whether a start displaced by the tolerance ends elsewhere, where computed",
        **_NO_YES,
    },
    "flagged": {
        "long_name": "whether the outcome may be another",
        "comment": f"sensitive, or filled within {BESIDE} nodes of another outcome",
        **_NO_YES,
    },
    "level": {"long_name": "refinement level: how often the coarse cell was halved"},
    "trajectories": {"long_name": "starts computed at this node, 0 where it was filled"},
    "reliable_share": {"long_name": "share of excitation phases and tilts from which it aligns"},
    "reliable": {"long_name": "whether it aligns from all of them", **_NO_YES},
    "tau_worst": {"long_name": "longest alignment duration from any of them", "symbol": "τ"},
    "margin": {
        "long_name": "distance to the nearest node that is not reliable",
        "comment": "each axis' range is the unit along it; infinite if there is no such node",
    },
}


Mark = tuple[str, list[float], list[float]]
"""(figure, its values of x, its values of y): two values are the ends of a range."""


def map_dataset(
    found: StabilityMap, title: str, summary: str, marks: Sequence[Mark] = ()
) -> xr.Dataset:
    """The map as an ordinary gridded dataset, dims (y parameter, x parameter).

    ``marks`` say where other figures of the study stand in this plane.
    """
    plan = found.plan
    dims = (plan.y.parameter, plan.x.parameter)
    variables = {
        name: (dims, getattr(found, name), {"units": "1", **attributes})
        for name, attributes in MAP_VARIABLES.items()
    }
    attributes = plane_attributes(plan, "map", title, summary)
    attributes |= {
        "coarse_cells": plan.cells // plan.lattice.coarse,
        "operating_points": json.dumps(list(marks)),
        "computed_share": float(found.computed.mean()),
        **map_counts(found),
    }
    if plan.ensemble is not None:
        starts = plan.starts()
        attributes |= {
            "reliable_means": "aligns within the horizon from every start of the ensemble",
            "ensemble_phases": sorted({start["phase"] for start in starts}),
            "ensemble_tilts": sorted({start["initial_tilt"] for start in starts}),
            "ensemble_resolution": plan.ensemble_lattice.cells,
        }
    return xr.Dataset(variables, plane_coordinates(plan), attributes)


def in_si(dataset: xr.Dataset, units: Units) -> xr.Dataset:
    """A map with its parameters and durations in SI units, which ``units`` and "units" name."""
    quantities = {name: FIELDS[str(name)].quantity for name in dataset.coords}
    quantities |= {name: TIME for name in dataset.data_vars if str(name).startswith("tau_")}
    found = dataset.copy()
    for name, quantity in quantities.items():
        attributes = {**dataset[name].attrs, "units": quantity.unit}
        found[name] = (dataset[name].dims, dataset[name].values * units.of(quantity), attributes)
    for name, (words, unit) in UNITS.items():
        found.coords[name] = ((), getattr(units, name), {"long_name": words, "units": unit})
    return found


def map_counts(found: StabilityMap) -> dict[str, int]:
    """What a map's sidecar counts: starts computed, and their evaluations."""
    return {
        "trajectories": int(found.trajectories.sum()),
        "rhs_evaluations": found.rhs_evaluations,
    }


def plane_coordinates(plan: MapPlan, derived: Collection[str] = ()) -> dict[str, Any]:
    """Varied parameters as dimension coordinates, held ones as scalar ones, without ``derived``."""
    swept = {plan.y.parameter: plan.y.values, plan.x.parameter: plan.x.values}
    coordinates: dict[str, Any] = {
        name: (name, values, parameter_attributes(name)) for name, values in swept.items()
    }
    for name in plan.parameters.keys() - swept.keys() - set(derived):
        value, attributes = plan.parameters[name], parameter_attributes(name)
        if value is None:
            attributes["comment"] = f"NaN stands for {FIELDS[name].derived}"
        coordinates[name] = ((), np.nan if value is None else value, attributes)
    return dict(sorted(coordinates.items()))


def plane_attributes(plan: MapPlan, kind: str, title: str, summary: str) -> dict[str, Any]:
    """What the dataset of a map says of itself."""
    settings = plan.settings.settings
    found = global_attributes(plan.name, kind, plan.identity, title, summary, settings)
    return {**found, "resolution": plan.cells}


def marks_of(study: Study, name: str) -> list[Mark]:
    """Where the histories and curves of a study stand in the plane of its map ``name``."""
    plane = study.plane(name)
    found: list[Mark] = []
    for figure in HISTORIES + CURVES:
        spec, held = study.figures[figure], study.parameters(figure)
        values = {each: [getattr(held, each)] for each in (plane.x.parameter, plane.y.parameter)}
        families: dict[str, list[float]] = {}
        if isinstance(spec, Curves):
            values[spec.swept.parameter] = [spec.swept.start, spec.swept.stop]
            families = {spec.family.parameter: spec.family.values}
        choices = [
            [[value] for value in families[each]] if each in families else [values[each]]
            for each in (plane.x.parameter, plane.y.parameter)
        ]
        found += [(figure, x, y) for x in choices[0] for y in choices[1]]
    return found


def work_counts(work: Work) -> dict[str, int]:
    """What a part's sidecar counts."""
    outcome = work.paper.of(*work.paper.nodes)["outcome"]
    evaluations = sum(int(known.columns["rhs_evaluations"].sum()) for known in work.known.values())
    return {
        "trajectories": work.trajectories,
        **{each.name.lower(): int((outcome == each).sum()) for each in Outcome},
        "sensitive": int((work.paper.columns["sensitive"] == 1).sum()),
        "rhs_evaluations": evaluations,
    }
