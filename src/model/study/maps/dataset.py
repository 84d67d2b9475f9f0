"""Datasets of maps: the variables, the nodes of parts on disk, and the full grid."""

import itertools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from model.engines.results import UNVIBRATED_CONTROL
from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS
from model.physics.quantities import ANGLE, TIME
from model.physics.units import UNITS
from model.study.devices.base import BASE
from model.study.io import (
    NO_YES,
    VARIABLES,
    global_attributes,
    parameter_coordinates,
    read_pieces,
    summary_of,
)
from model.study.maps.compute import PERIODS, SHARE, Computation, MapNodes, Progress
from model.study.maps.lattice import AROUND, BESIDE, PATCH, WINDOW, Bools, Floats
from model.study.maps.plan import MapPlan, Mark
from model.study.maps.starts import sum_up_starts

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
        **NO_YES,
    },
    **{name: VARIABLES[name] for name in UNVIBRATED_CONTROL},
    "flagged": {
        "long_name": "the outcome may be another",
        "comment": f"sensitive, or filled within {BESIDE} nodes of another outcome, within "
        f"{2 * BESIDE} where the border is crooked, or within {AROUND} of a patch",
        **NO_YES,
    },
    "patch": {
        "long_name": "outcomes alternate: no border is drawn here",
        "comment": f"the border crosses more than {PATCH:g} of the {WINDOW} x {WINDOW} small cells "
        "around",
        **NO_YES,
    },
    "level": {"long_name": "refinement level: how often the coarse cell was halved"},
    "trajectories": {"long_name": "starts computed at this node, 0 where it was filled"},
    "reliable_share": {
        "long_name": "share of the ensemble's starts tried here that align",
        "comment": "the paper's start included; no other is tried where it fails",
    },
    "reliable": {
        "long_name": "aligns from every start of the ensemble",
        "comment": "starts are tried where the paper's aligns: all beside nodes that fail, those "
        "from which nodes near fail, and few inside",
        **NO_YES,
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


# --- Parts on disk --------------------------------------------------------------------------------


def part_dataset(plan: MapPlan, part: int, parts: int, nodes: MapNodes) -> xr.Dataset:
    """Return the dataset of a part: the columns of every step over the nodes computed in it."""
    variables: dict[str, Any] = {}
    for step, store in nodes.steps().items():
        rows, columns = np.nonzero(store.computed)
        values = {"row": rows.astype(np.int32), "column": columns.astype(np.int32)}
        values |= store.at(rows, columns)
        variables |= {
            f"{step}_{name}": (
                (step, f"{step}_start")[: value.ndim],
                value,
                {"units": "1", "long_name": f"{name.replace('_', ' ')} of the step {step!r}"},
            )
            for name, value in values.items()
        }
    words = {
        "title": f"{plan.name}: part {part + 1} of {parts}",
        "summary": "Nodes of a map that one job has computed, before they are assembled.",
    }
    stated = {"figure": plan.name, "config_hash": plan.identity, "part": part, "parts": parts}
    return xr.Dataset(variables, attrs=words | stated)


def part_counts(nodes: MapNodes) -> dict[str, int]:
    """Return the counts for the sidecar of a part: starts computed, outcomes, and evaluations."""
    nominal = nodes.nominal
    outcome = nominal.columns["outcome"][nominal.computed]
    return {
        "trajectories": nodes.trajectories(),
        **{kind.name.lower(): int((outcome == kind).sum()) for kind in Outcome},
        "sensitive": int((nominal.columns["sensitive"] == 1).sum()),
        "rhs_evaluations": nodes.evaluations(),
    }


def read_parts(plan: MapPlan, paths: Sequence[Path]) -> MapNodes:
    """Return the nodes of all parts of a map.

    Raises:
        DatasetError: as ``read_pieces``.
    """
    nodes = MapNodes(plan)
    for stored in read_pieces("part", paths, plan.name, plan.identity):
        for step, store in nodes.steps().items():
            rows, columns = (stored[f"{step}_{side}"].values for side in ("row", "column"))
            values = {name: stored[f"{step}_{name}"].values for name in store.columns}
            store.enter(rows, columns, values)
    return nodes


# --- The map --------------------------------------------------------------------------------------


def map_dataset(
    plan: MapPlan,
    nodes: MapNodes,
    title: str,
    marks: Sequence[Mark] = (),
    *,
    cores: int = 1,
    progress: Progress = lambda *_: None,
) -> xr.Dataset:
    """Return a map as a grid (y parameter, x parameter), other parameters as scalar coordinates.

    Missing nodes are computed and entered into ``nodes``. ``marks`` are the operating points of
    other figures in this plane.
    """
    values = assemble(plan, nodes, cores=cores, progress=progress)
    settings = plan.settings.settings
    if plan.device is None:
        summary = summary_of({axis.parameter: len(axis.values) for axis in (plan.y, plan.x)})
    else:
        summary = (
            f"Results over {plan.y.parameter} by {plan.x.parameter}, {plan.y.count} values of each."
        )
    attributes = global_attributes(plan.name, "map", plan.identity, title, summary, settings)
    attributes |= {
        "resolution": plan.cells,
        "coarse_cells": plan.cells // plan.lattice.coarse,
        "operating_points": json.dumps(list(marks)),
        "computed_share": float(nodes.nominal.computed.mean()),
        "trajectories": int(values["trajectories"].sum()),
        "rhs_evaluations": nodes.evaluations(),
    }
    if plan.ensemble is not None:
        starts = plan.starts()
        attributes |= {
            "reliable_means": "aligns within the horizon from every start of the ensemble",
            "ensemble_phases": sorted({start["phase"] for start in starts}),
            "ensemble_tilts": sorted({start["initial_tilt"] for start in starts}),
            "ensemble_resolution": plan.ensemble_lattice.cells,
        }
    dims = (plan.y.parameter, plan.x.parameter)
    swept = {plan.y.parameter: plan.y.values, plan.x.parameter: plan.x.values}
    variables = {
        name: (dims, values[name], {"units": "1", **known}) for name, known in MAP_VARIABLES.items()
    }
    if plan.device is None:
        coordinates = parameter_coordinates(swept, plan.parameters)
    else:
        coordinates, time = _in_si(plan)
        for name in [each for each in variables if each.startswith("tau_")]:
            known = variables[name][2] | {"units": TIME.unit}
            variables[name] = (dims, values[name] * time, known)
    return xr.Dataset(variables, dict(sorted(coordinates.items())), attributes)


def map_counts(dataset: xr.Dataset) -> dict[str, int]:
    """Return the counts for the sidecar of a map: starts computed, and evaluations."""
    return {name: int(dataset.attrs[name]) for name in ("trajectories", "rhs_evaluations")}


def assemble(
    plan: MapPlan, nodes: MapNodes, *, cores: int = 1, progress: Progress = lambda *_: None
) -> dict[str, NDArray[Any]]:
    """Compute the missing nodes of a map, and fill all nodes in between.

    Returns:
        The variables of the map, each of shape (cells + 1, cells + 1), rows along y. They do not
        depend on the parts that ``nodes`` come from.
    """
    nominal, unvibrated = Computation(plan, nodes, cores, progress).run()
    runs, controls = nodes.nominal.columns, nodes.unvibrated.columns
    outcome = nominal.spread(runs["outcome"])
    aligns = outcome == plan.settings.settings.success
    duration = np.where(aligns, nominal.filled(runs["tau_align"]), np.nan)
    sensitive = runs["sensitive"] == 1
    trajectories = nodes.nominal.computed.astype(np.int32)
    return {
        "outcome": outcome,
        "reason": nominal.spread(runs["reason"]),
        "tau_align": duration,
        "tau_error": runs["tau_error"],
        "sensitive": sensitive.astype(np.int8),
        "unvibrated": unvibrated.spread(controls["unvibrated"]),
        "unvibrated_tilt": unvibrated.filled(controls["unvibrated_tilt"]),
        "slow_tilt": unvibrated.filled(controls["slow_tilt"]),
        "flagged": (sensitive | nominal.flagged).astype(np.int8),
        "patch": nominal.patch.astype(np.int8),
        "level": nominal.level.astype(np.int8),
        **_reliability(plan, nodes, aligns, duration, trajectories),
    }


def _reliability(
    plan: MapPlan, nodes: MapNodes, aligns: Bools, duration: Floats, trajectories: NDArray[np.int32]
) -> dict[str, NDArray[Any]]:
    """Return the variables of a map that depend on the ensemble."""
    reliable, share, worst = aligns, *np.full((2, *aligns.shape), np.nan)
    if nodes.ensemble is not None:
        tried, coarser = nodes.ensemble.columns, (slice(None, None, plan.stride),) * 2
        shares, excess, runs = sum_up_starts(
            tried["end"], tried["tau"], aligns[coarser], duration[coarser]
        )
        share = _between(np.minimum, shares, plan.stride)
        worst = duration + _between(np.maximum, excess, plan.stride)
        reliable = aligns & (share == 1.0)
        trajectories[coarser] += runs
    return {
        "trajectories": trajectories,
        "reliable_share": share,
        "reliable": reliable.astype(np.int8),
        "tau_worst": np.where(reliable, worst, np.nan),
        "margin": _margin(reliable),
    }


def _margin(inside: Bools) -> Floats:
    """Return the distance of nodes to the nearest node outside; a side of the map is 1."""
    if inside.all():
        return np.full(inside.shape, np.inf)
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415  (slow)

    distance: Floats = distance_transform_edt(inside, sampling=1.0 / (len(inside) - 1))
    return distance


def _between(worse: np.ufunc, values: Floats, stride: int) -> Floats:
    """Return values on a lattice ``stride`` times finer; a new node takes the worse neighbour's."""
    for axis in (0, 1):
        rows = np.moveaxis(values, axis, 0)
        finer = np.repeat(worse(rows[:-1], rows[1:]), stride, axis=0)
        finer = np.concatenate([finer, rows[-1:]])
        finer[::stride] = rows
        values = np.moveaxis(finer, 0, axis)
    return values


def _in_si(plan: MapPlan) -> tuple[dict[str, Any], Floats]:
    """Return the coordinates of a device's map in SI units, and the unit of time at its nodes.

    A quantity that follows from those along the axes is no coordinate.
    """
    device, dims = plan.device, (plan.y.parameter, plan.x.parameter)
    assert device is not None  # noqa: S101  (called for maps of a device)
    corners = [
        device.changed(**dict(zip(dims, ends, strict=True))).values
        for ends in itertools.product(*((axis.start, axis.stop) for axis in (plan.y, plan.x)))
    ]
    held = {n: v for n, v in device.values.items() if all(each.get(n) == v for each in corners)}
    values: dict[str, Any] = held | {axis.parameter: axis.values for axis in (plan.y, plan.x)}
    coordinates = {
        name: ((name,) if name in dims else (), value, _attributes_in_si(name))
        for name, value in values.items()
    }
    mass, stiffness = (
        np.asarray(values[name]).reshape([-1 if name == each else 1 for each in dims])
        for name in ("mass", "axial_stiffness")
    )
    return coordinates, np.broadcast_to(np.sqrt(mass / stiffness), (plan.cells + 1,) * 2)


def _attributes_in_si(name: str) -> dict[str, Any]:
    if name in BASE:
        return {"long_name": BASE[name][0], "units": BASE[name][1]}
    field = (FIELDS | UNITS)[name]  # type: ignore[operator]
    attributes = {"long_name": field.description, "symbol": field.symbol}
    is_angle = field.quantity is ANGLE  # CF's word differs from the SI symbol
    return attributes | {"units": "radian" if is_angle else field.quantity.unit}
