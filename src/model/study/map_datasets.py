"""Datasets of maps: grids over two parameters, and the meaning of their variables."""

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.engines.results import UNVIBRATED_CONTROL
from model.events.outcomes import Outcome, Unvibrated
from model.events.scenes import ALIGNMENT
from model.physics.parameters import FIELDS
from model.physics.quantities import TIME
from model.physics.units import UNITS, Units
from model.runs.settings import SCENES, Settings
from model.study.config.figures import CURVES, HISTORIES, Curves
from model.study.datasets import VARIABLES, global_attributes, parameter_coordinates
from model.study.map_parts import AllKnown, Progress
from model.study.maps import PERIODS, SHARE, MapPlan, assemble, evaluations
from model.study.refinement import AROUND, BESIDE, PATCH, WINDOW
from model.study.starts import GOES_IN

if TYPE_CHECKING:
    from model.study.config.study import Study

_NO_YES = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "no yes"}
LEVEL = {"long_name": "refinement level: how often the coarse cell was halved"}

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
        "long_name": "a start displaced by the tolerance ends differently, where computed",
        **_NO_YES,
    },
    **{name: VARIABLES[name] for name in UNVIBRATED_CONTROL},
    "flagged": {
        "long_name": "the outcome may be another",
        "comment": f"sensitive, or filled within {BESIDE} nodes of another outcome, within "
        f"{2 * BESIDE} where the border is crooked, or within {AROUND} of a patch",
        **_NO_YES,
    },
    "patch": {
        "long_name": "outcomes alternate: no border is drawn here",
        "comment": f"the border crosses more than {PATCH:g} of the {WINDOW} x {WINDOW} small cells "
        "around",
        **_NO_YES,
    },
    "level": LEVEL,
    "trajectories": {"long_name": "starts computed at this node, 0 where it was filled"},
    "reliable_share": {
        "long_name": "share of the ensemble's starts tried here that align",
        "comment": "the paper's start included; no other is tried where it fails",
    },
    "reliable": {
        "long_name": "aligns from every start of the ensemble",
        "comment": "starts are tried where the paper's aligns: all beside nodes that fail, those "
        "from which nodes near fail, and few inside",
        **_NO_YES,
    },
    "tau_worst": {
        "long_name": "longest alignment duration of the starts tried",
        "symbol": "τ",
        "comment": "where none but the paper's was tried, as much longer than from this one as at "
        "the nearest node where others were",
    },
    "margin": {
        "long_name": "distance to the nearest node that is not reliable",
        "comment": "each axis' range is the unit along it; infinite if there is no such node",
    },
}
"""Attributes of the variables of a map, in the order of its dataset."""

BOTH, ONLY_VIBRATED, ONLY_PRESSED, NEITHER = range(4)


def success_of(dataset: xr.Dataset) -> Outcome:
    """Return the outcome of a run that ends well in the scene of a map or figure."""
    return Settings(scene=SCENES[dataset.attrs.get("scene", ALIGNMENT.name)]).success


def added(dataset: xr.Dataset) -> NDArray[np.int64]:
    """Return the share of vibration at every point of a map or figure, in the shape of its outcome.

    BOTH: the part aligns with and without vibration; ONLY_VIBRATED, ONLY_PRESSED: it aligns with
    vibration alone, or without alone; NEITHER: it aligns in no way.
    """
    vibrated = np.isin(dataset["outcome"].values, GOES_IN)
    pressed = dataset["unvibrated"].values == Unvibrated.ALIGNS
    return np.select(
        [vibrated & pressed, vibrated, pressed], [BOTH, ONLY_VIBRATED, ONLY_PRESSED], NEITHER
    )


Mark = tuple[str, list[float], list[float]]
"""(figure, its values of x, its values of y): two values are the ends of a range."""


def map_dataset(
    plan: MapPlan,
    known: AllKnown,
    title: str,
    summary: str,
    marks: Sequence[Mark] = (),
    *,
    cores: int = 1,
    progress: Progress = lambda *_: None,
) -> xr.Dataset:
    """Assemble a map from its parts (``maps.assemble``), dims (y parameter, x parameter).

    ``marks`` are the operating points of other figures of the study in this plane.
    """
    values = assemble(plan, known, cores=cores, progress=progress)
    attributes = {
        "coarse_cells": plan.cells // plan.lattice.coarse,
        "operating_points": json.dumps(list(marks)),
        "computed_share": float(known["paper"].computed.mean()),
        "trajectories": int(values["trajectories"].sum()),
        "rhs_evaluations": evaluations(known),
    }
    if plan.ensemble is not None:
        starts = plan.starts()
        attributes |= {
            "reliable_means": "aligns within the horizon from every start of the ensemble",
            "ensemble_phases": sorted({start["phase"] for start in starts}),
            "ensemble_tilts": sorted({start["initial_tilt"] for start in starts}),
            "ensemble_resolution": plan.ensemble_lattice.cells,
        }
    attributes = plane_attributes(plan, "map", title, summary) | attributes
    return plane_dataset(plan, MAP_VARIABLES, values, attributes)


def map_counts(dataset: xr.Dataset) -> dict[str, int]:
    """Return the counts in the sidecar of a map: starts computed, and evaluations if counted."""
    names = ("trajectories", "rhs_evaluations")
    return {name: int(dataset.attrs[name]) for name in names if name in dataset.attrs}


def plane_dataset(
    plan: MapPlan,
    variables: Mapping[str, Mapping[str, Any]],
    values: Mapping[str, NDArray[Any]],
    attributes: Mapping[str, Any],
) -> xr.Dataset:
    """Return a gridded dataset: varied parameters as dimensions, held ones as scalar coordinates.

    Args:
        plan: the plane.
        variables: attributes of each variable, by name.
        values: values of each variable, shape (cells + 1, cells + 1), rows along y.
        attributes: attributes of the dataset.
    """
    dims = (plan.y.parameter, plan.x.parameter)
    swept = {plan.y.parameter: plan.y.values, plan.x.parameter: plan.x.values}
    coordinates = parameter_coordinates(swept, plan.parameters)
    return xr.Dataset(
        {name: (dims, values[name], {"units": "1", **each}) for name, each in variables.items()},
        dict(sorted(coordinates.items())),
        attributes,
    )


def plane_attributes(plan: MapPlan, kind: str, title: str, summary: str) -> dict[str, Any]:
    """Return the attributes that all maps have."""
    settings = plan.settings.settings
    found = global_attributes(plan.name, kind, plan.identity, title, summary, settings)
    return {**found, "resolution": plan.cells}


def in_si(dataset: xr.Dataset, units: Units) -> xr.Dataset:
    """Return a map with parameters and durations in SI units, and ``units`` as coordinates."""
    quantities = {name: FIELDS[str(name)].quantity for name in dataset.coords}
    quantities |= {name: TIME for name in dataset.data_vars if str(name).startswith("tau_")}
    found = dataset.copy()
    for name, quantity in quantities.items():
        attributes = {**dataset[name].attrs, "units": quantity.unit}
        values = dataset[name].values * units.of(quantity)
        if name in dataset.dims:  # 400, not 400.0000000001788: scaled to the model's units and back
            values = np.array([float(f"{value:.12g}") for value in values])
        found[name] = (dataset[name].dims, values, attributes)
    for name, (words, unit) in UNITS.items():
        found.coords[name] = ((), getattr(units, name), {"long_name": words, "units": unit})
    return found


def marks_of(study: "Study", name: str) -> list[Mark]:
    """Return the operating points of a study's histories and curves in its map ``name``."""
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
