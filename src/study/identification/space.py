"""The unknowns, and the sweeps that they stand for.

Each unknown has a coordinate in [0, 1], on the log axis of its prior. Dampings are searched as
damping ratios and the inertia as a multiple of the bare part's, as the priors are stated.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from model.sweeps.axes import Axis, Family, Plan
from model.sweeps.settings import RunSettings
from model.sweeps.sweep import Sweep
from study.config.base import LogRange
from study.config.identification import Grid, Problem
from study.plans import sweep_of

if TYPE_CHECKING:
    from study.config.study import Study

Array = NDArray[np.float64]

DEVICE = (  # the parameters that ``structure_of`` returns
    "half_width", "half_height", "inertia",
    "lateral_stiffness", "lateral_damping", "axial_damping", "tilt_damping",
)  # fmt: skip
TYPICAL_TILT_STIFFNESS = 10.0  # at which the tilt's damping ratio is taken; the paper varies k_φ
INERTIAS = 0.5, 2.0  # ends of Fig. 10's axis, over the inertia of the device


class Space(Plan):
    """The search as data.

    Attributes:
        problem: priors, limits and grids.
        fixed: parameters that are not searched.
        dimensions: dimensions of each figure on the study's own grid.
        settings: the study's own settings.
    """

    problem: Problem
    fixed: dict[str, float | None]
    dimensions: dict[str, list[Axis | Family]]
    settings: RunSettings

    @cached_property
    def figures(self) -> tuple[str, ...]:
        """Names of the figures."""
        return tuple(self.problem.operating_points)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns: "half_width", …, "fig06.friction", …."""
        points = self.problem.operating_points.items()
        return (
            *self.problem.structure,
            *(f"{figure}.{name}" for figure, priors in points for name in priors),
        )

    @cached_property
    def places(self) -> Mapping[str, slice]:
        """Coordinates of the structure ("structure") and of each figure."""
        parts = {"structure": self.problem.structure, **self.problem.operating_points}
        ends = np.cumsum([len(priors) for priors in parts.values()]).tolist()
        return {
            part: slice(end - len(parts[part]), end) for part, end in zip(parts, ends, strict=True)
        }

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        parts = [self.problem.structure, *self.problem.operating_points.values()]
        priors = [prior for part in parts for prior in part.values()]
        return np.array([p.low for p in priors]), np.array([p.high for p in priors])

    def values(self, point: Array) -> dict[str, float]:
        """Return the values of all unknowns at coordinates of shape (n,)."""
        low, high = self._ends
        return dict(zip(self.names, (low * (high / low) ** point).tolist(), strict=True))

    def point(self, values: Mapping[str, float]) -> Array:
        """Return coordinates of values, held inside the priors, shape (n,)."""
        low, high = self._ends
        given = np.array([values[name] for name in self.names])
        return np.clip(np.log(given / low) / np.log(high / low), 0.0, 1.0)

    def half_widths(self, kept: LogRange) -> tuple[float, float]:
        """Return the coordinates of the ends of a range of half-widths."""
        prior = self.problem.structure["half_width"]
        low, high = (math.log(end / prior.low) for end in (kept.low, kept.high))
        return low / math.log(prior.high / prior.low), high / math.log(prior.high / prior.low)

    def sweep(self, values: Mapping[str, float], figure: str, grid: Grid) -> Sweep:
        """Return the sweep of a figure at values of the unknowns."""
        device = structure_of(values)
        operating = {
            unknown.partition(".")[2]: value
            for unknown, value in values.items()
            if unknown.startswith(f"{figure}.")
        }
        parameters = {**self.fixed, **device, **operating, **self.problem.stated.get(figure, {})}
        stated = self.dimensions[figure]
        axes, count = sum(isinstance(each, Axis) for each in stated), grid.counts[figure]
        counts = count if isinstance(count, list) else [count] * len(stated)
        dimensions = [
            _on_grid(each, number, parameters) for each, number in zip(stated, counts, strict=True)
        ]
        return Sweep.model_construct(
            name=figure,
            kind="map" if axes == 2 else "curves" if axes else "history",
            parameters=parameters,
            settings=self.settings.model_copy(
                update={"horizon": grid.horizon, "tolerance": grid.tolerance}
            ),
            dimensions=dimensions,
            variables=("outcome", "tau_align", "separations", "tilt_at_alignment", "tilt_max",
                       "tau_corners_inside", "unvibrated", "unvibrated_tilt", "slow_tilt"),
        )  # fmt: skip


def _on_grid(dimension: Axis | Family, count: int, parameters: Mapping[str, Any]) -> Axis | Family:
    """Return a dimension with ``count`` values; Fig. 10's is about the inertia of the device."""
    if isinstance(dimension, Family):
        return dimension
    ends = {}
    if dimension.parameter == "inertia":
        low, high = (factor * parameters["inertia"] for factor in INERTIAS)
        ends = {"start": low, "stop": high}
    return dimension.model_copy(update={"count": count, **ends})


def space_of(study: "Study") -> Space:
    """Return the search space; another device of the study is no other search."""
    spec = study.identification
    stated = {**study.operating_point, **study.structure}
    problem = {name: getattr(spec, name) for name in Problem.model_fields}
    # In a fixed order: Snakemake compares the texts of parameters, and a set's order changes.
    unknown = sorted({name for point in spec.operating_points.values() for name in point})
    fixed = {name: value for name, value in stated.items() if name not in {*unknown, *DEVICE}}
    return Space(
        problem=Problem(**problem),
        # A figure sets every unknown, or sweeps it: then no run uses the 1 that stands for it here.
        fixed={**dict.fromkeys(unknown, 1.0), "rest_x": None, "rest_y": None, **fixed},
        dimensions={name: sweep_of(study, name).dimensions for name in spec.operating_points},
        settings=study.settings,
    )


def configuration(space: Space, values: Mapping[str, float]) -> dict[str, Any]:
    """Return a device and its operating points as they stand in config.yaml."""

    def rounded(stated: Mapping[str, float]) -> dict[str, float]:
        return {name: float(f"{value:.4g}") for name, value in stated.items()}

    held = {
        figure: rounded(
            space.problem.stated.get(figure, {})
            | {name: values[f"{figure}.{name}"] for name in priors}
        )
        for figure, priors in space.problem.operating_points.items()
    }
    return {"structure": rounded(structure_of(values)), "held": held}


def structure_of(values: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of the device from the unknowns.

    A damping is 2 ζ √(k m), with the mass 1 of the body or its inertia and the stiffness of the
    same direction; the inertia is the ratio times that of the homogeneous rectangle, (a² + b²)/3.
    """
    sizes = {
        "half_width": values["half_width"],
        "half_height": values["slenderness"] * values["half_width"],
    }
    inertia = values["inertia_ratio"] * bare_inertia(sizes)
    lateral = 2.0 * math.sqrt(values["lateral_stiffness"])
    tilt = 2.0 * math.sqrt(TYPICAL_TILT_STIFFNESS * inertia)
    return {
        **sizes,
        "inertia": inertia,
        "lateral_stiffness": values["lateral_stiffness"],
        "lateral_damping": values["lateral_damping_ratio"] * lateral,
        "axial_damping": 2.0 * values["axial_damping_ratio"],
        "tilt_damping": values["tilt_damping_ratio"] * tilt,
    }


def own_values(study: "Study", space: Space) -> dict[str, float]:
    """Return the values of all unknowns of the study's own device; the reverse of ``Space``."""
    device = study.baseline
    lateral = 2.0 * math.sqrt(device.lateral_stiffness)
    tilt = 2.0 * math.sqrt(TYPICAL_TILT_STIFFNESS * device.inertia)
    values = {
        "half_width": device.half_width,
        "slenderness": device.half_height / device.half_width,
        "inertia_ratio": device.inertia / bare_inertia(device.given()),
        "lateral_stiffness": device.lateral_stiffness,
        "lateral_damping_ratio": device.lateral_damping / lateral,
        "axial_damping_ratio": device.axial_damping / 2.0,
        "tilt_damping_ratio": device.tilt_damping / tilt,
    }
    for figure, priors in space.problem.operating_points.items():
        held = study.parameters(figure)
        values |= {f"{figure}.{name}": getattr(held, name) for name in priors}
    return values


def bare_inertia(values: Mapping[str, Any]) -> float:
    """Return the moment of inertia of the homogeneous rectangle of mass 1."""
    return float((values["half_width"] ** 2 + values["half_height"] ** 2) / 3.0)
