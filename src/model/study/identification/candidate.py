"""The search space: points of the unit cube, and the devices and figures that they encode.

Each coordinate of a point is one unknown on a logarithmic axis: first those of the structure,
shared by all figures, then each figure's operating point. Dampings are searched as damping ratios
and the inertia as a multiple of the bare part's, because the priors are stated in these;
``structure_of`` turns them into the parameters of the equations.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import check_name
from model.physics.readings import READING_NAMES, Reading
from model.study.config import (
    Axis,
    ClaimRun,
    Curves,
    Family,
    Map,
    RunSettings,
    SearchLaw,
    Study,
)
from model.study.plan import Plan
from model.study.sweeps import Sweep

TYPICAL_TILT_STIFFNESS = 10.0  # at which the tilt's damping ratio is taken; the paper varies k_φ
FINE_TOLERANCE = 1e-8
REST_HORIZON = 300.0  # what is not vibrated must be seen to come to rest
DEVICE = (  # the parameters that ``structure_of`` returns
    "half_width", "half_height", "inertia",
    "lateral_stiffness", "lateral_damping", "axial_damping", "tilt_damping",
)  # fmt: skip
MOST_INERTIA = 4.0  # of Fig. 10's axis, over the inertia of the bare part

Array = NDArray[np.float64]


class Space(Plan):
    """The search as data; its JSON is its identity.

    Attributes:
        fixed: parameters that are not searched: stated by the paper, or held.
        dimensions: of each sweep, a figure's or one of the claims' own runs, on the coarse grid.
        runs: the claims' own runs.
        law: priors, grids and settings.
        readings: variant of the equations: every reading by name.
    """

    fixed: dict[str, float]
    dimensions: dict[str, list[Axis | Family]]
    runs: dict[str, ClaimRun]
    law: SearchLaw
    readings: dict[str, Reading]

    @cached_property
    def settings(self) -> RunSettings:
        """Settings of the search's runs."""
        return RunSettings(
            readings=self.readings, horizon=self.law.horizon, tolerance=self.law.tolerance
        )

    @cached_property
    def at_rest(self) -> RunSettings:
        """Settings of runs without vibration, which are given the time to come to rest."""
        return self.settings.model_copy(
            update={"horizon": REST_HORIZON, "tolerance": FINE_TOLERANCE}
        )

    @cached_property
    def figures(self) -> tuple[str, ...]:
        """The figures that are computed."""
        return tuple(name for name in self.dimensions if name not in self.runs)

    @cached_property
    def parts(self) -> Mapping[str, tuple[str, ...]]:
        """Each figure with the claims' own runs at its operating point."""
        return {
            figure: (figure, *(name for name, run in self.runs.items() if run.figure == figure))
            for figure in self.figures
        }

    @cached_property
    def everything(self) -> tuple[str, ...]:
        """All figures and own runs."""
        return tuple(name for names in self.parts.values() for name in names)

    @cached_property
    def searched(self) -> tuple[str, ...]:
        """Those that a search computes; the others are judged on the finer grids only."""
        return tuple(name for name in self.everything if name not in self.law.finer_only)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the coordinates: "inertia_ratio", …, "fig06.friction", …."""
        of_figures = [
            f"{figure}.{name}"
            for figure, ranges in self.law.operating_points.items()
            for name in ranges
        ]
        return (*self.law.structure, *of_figures)

    @cached_property
    def places(self) -> Mapping[str, slice]:
        """Coordinates of the structure ("structure") and of each figure."""
        found, start = {}, 0
        parts = {"structure": self.law.structure, **self.law.operating_points}
        for part, ranges in parts.items():
            found[part] = slice(start, start + len(ranges))
            start += len(ranges)
        return found

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        parts = [self.law.structure, *self.law.operating_points.values()]
        ranges = [law for part in parts for law in part.values()]
        return np.array([law.low for law in ranges]), np.array([law.high for law in ranges])

    def only(self, names: Collection[str]) -> "Space":
        """The same space, of which some figures and own runs alone are computed."""
        return Space(
            fixed=self.fixed,
            dimensions={name: each for name, each in self.dimensions.items() if name in names},
            runs={name: run for name, run in self.runs.items() if name in names},
            law=self.law,
            readings=self.readings,
        )

    def values(self, points: Array) -> Array:
        """Values of the unknowns at coordinates in [0, 1]; shape (..., n) both."""
        low, high = self._ends
        return low * (high / low) ** points

    def point(self, values: Array) -> Array:
        """Coordinates of values, held inside the space; the inverse of ``values``."""
        low, high = self._ends
        return np.clip(np.log(values / low) / np.log(high / low), 0.0, 1.0)

    def point_of(self, stated: Mapping[str, float]) -> Array:
        """The point of values by unknown, shape (n,).

        Raises:
            ValueError: an unknown that is missing.
        """
        missing = [name for name in self.names if name not in stated]
        if missing:
            raise ValueError(f"known: missing {', '.join(missing)}")
        return self.point(np.array([stated[name] for name in self.names]))

    def structure(self, point: Array) -> dict[str, float]:
        """The parameters of the device at a point."""
        part = self.values(point)[self.places["structure"]].tolist()
        return structure_of(dict(zip(self.law.structure, part, strict=True)))

    def held(self, point: Array, figure: str) -> dict[str, float]:
        """The operating point of a figure."""
        names = self.law.operating_points.get(figure, {})
        part = self.values(point)[self.places[figure]].tolist() if names else []
        return {**self.law.stated.get(figure, {}), **dict(zip(names, part, strict=True))}

    def sweep(self, point: Array, name: str) -> Sweep:
        """A figure of the device at a point, or an own run of the ledger, on the coarse grid."""
        structure, run = self.structure(point), self.runs.get(name)
        parameters: dict[str, float | None] = {**dict.fromkeys(("rest_x", "rest_y")), **self.fixed}
        parameters |= structure | self.held(point, run.figure if run else name)
        if run:
            parameters |= run.changes(structure["half_width"], self.fixed["clearance"])
        dimensions = [
            dimension.model_copy(
                update=dict(zip(("start", "stop"), inertias(structure), strict=True))
            )
            if isinstance(dimension, Axis) and dimension.parameter == "inertia"
            else dimension
            for dimension in self.dimensions[name]
        ]
        return Sweep.model_construct(
            figure=name,
            kind=_kind(dimensions),
            parameters=parameters,
            settings=self.at_rest if parameters["frequency"] == 0.0 else self.settings,
            dimensions=dimensions,
        )


def _kind(dimensions: Sequence[Axis | Family]) -> Literal["history", "curves", "map"]:
    if not dimensions:
        return "history"
    return "curves" if isinstance(dimensions[0], Family) else "map"


def structure_of(searched: Mapping[str, float]) -> dict[str, float]:
    """Parameters of the equations from what is searched.

    A damping is 2 ζ √(k m), with the mass 1 of the body or its inertia and the stiffness of the
    same direction; the inertia is the ratio times that of the homogeneous rectangle, (a² + b²)/3.
    """
    inertia = searched["inertia_ratio"] * bare_inertia(searched)
    return {
        "half_width": searched["half_width"],
        "half_height": searched["half_height"],
        "inertia": inertia,
        "lateral_stiffness": searched["lateral_stiffness"],
        "lateral_damping": 2.0
        * searched["lateral_damping_ratio"]
        * math.sqrt(searched["lateral_stiffness"]),
        "axial_damping": 2.0 * searched["axial_damping_ratio"],
        "tilt_damping": 2.0
        * searched["tilt_damping_ratio"]
        * math.sqrt(TYPICAL_TILT_STIFFNESS * inertia),
    }


def searched_of(structure: Mapping[str, float]) -> dict[str, float]:
    """The inverse of ``structure_of``."""
    inertia, stiffness = structure["inertia"], structure["lateral_stiffness"]
    return {
        "half_width": structure["half_width"],
        "half_height": structure["half_height"],
        "inertia_ratio": inertia / bare_inertia(structure),
        "lateral_stiffness": stiffness,
        "lateral_damping_ratio": structure["lateral_damping"] / (2.0 * math.sqrt(stiffness)),
        "axial_damping_ratio": structure["axial_damping"] / 2.0,
        "tilt_damping_ratio": structure["tilt_damping"]
        / (2.0 * math.sqrt(TYPICAL_TILT_STIFFNESS * inertia)),
    }


def bare_inertia(structure: Mapping[str, float]) -> float:
    """Moment of inertia of the homogeneous rectangle, mass 1."""
    return (structure["half_width"] ** 2 + structure["half_height"] ** 2) / 3.0


def inertias(structure: Mapping[str, float]) -> tuple[float, float]:
    """Ends of Fig. 10's axis: from the bare part's inertia, below which there is none, upwards."""
    bare = bare_inertia(structure)
    return bare, MOST_INERTIA * bare


def readings_of(name: str) -> dict[str, Reading]:
    """Readings of a variant of the equations that is searched.

    Args:
        name: a preset, "consistent" or "printed"; or the one reading that is consistent while all
            others are printed.

    Raises:
        ValueError: an unknown name.
    """
    if name == "consistent":
        return dict.fromkeys(READING_NAMES, "consistent")
    switches: dict[str, Reading] = dict.fromkeys(READING_NAMES, "printed")
    if name != "printed":
        check_name(name, READING_NAMES, "reading")
        switches[name] = "consistent"
    return switches


def space_of(study: Study, finer: int = 1) -> Space:
    """The search space that a study's law describes.

    Args:
        study: the study.
        finer: factor on the values along each axis; above 1, runs have a smaller tolerance.
    """
    return _space(study, _finer(study.identification.law, finer), "consistent")


def space_of_reading(study: Study, reading: str, finer: int = 1) -> Space:
    """The smaller search under a reading, as ``readings_of`` takes it; ``finer`` as above."""
    identification = study.identification
    few = identification.law.model_copy(update={"counts": identification.reading_counts})
    return _space(study, _finer(few, finer), reading)


def space_of_figures(study: Study) -> Space:
    """The search space on the study's own grids, of maps with every second value, and horizon."""
    law = study.identification.law
    counts = {}
    for name in law.counts:
        spec = study.figures[name]
        if isinstance(spec, Curves):
            counts[name] = spec.swept.count
        elif isinstance(spec, Map):
            counts[name] = spec.x.count // 2
    run_counts = {name: study.claims_runs[name].swept.count for name in law.run_counts}
    grids = {"counts": counts, "run_counts": run_counts, "horizon": study.settings.horizon}
    own = law.model_copy(update={**grids, "tolerance": FINE_TOLERANCE})
    return _space(study, own, "consistent")


def _finer(law: SearchLaw, times: int) -> SearchLaw:
    if times == 1:
        return law
    counts = {name: times * count for name, count in law.counts.items()}
    run_counts = {name: times * count for name, count in law.run_counts.items()}
    return law.model_copy(
        update={"counts": counts, "run_counts": run_counts, "tolerance": FINE_TOLERANCE}
    )


def _space(study: Study, law: SearchLaw, reading: str) -> Space:
    """The space of the figures and own runs that the law names."""
    dimensions: dict[str, list[Axis | Family]] = {}
    for name in sorted({*law.counts, *law.operating_points}):
        spec = study.figures[name]
        count = {"count": law.counts.get(name)}
        if isinstance(spec, Curves):
            ends = {"start": 1.0, "stop": MOST_INERTIA} if spec.swept.parameter == "inertia" else {}
            dimensions[name] = [spec.family, spec.swept.model_copy(update={**count, **ends})]
        elif isinstance(spec, Map):
            dimensions[name] = [axis.model_copy(update=count) for axis in (spec.y, spec.x)]
        else:
            dimensions[name] = []
    runs = {name: run for name, run in study.claims_runs.items() if name in law.run_counts}
    for name, run in runs.items():
        swept = run.swept.model_copy(update={"count": law.run_counts[name]})
        dimensions[name] = [run.family, swept]
    # What is searched is not the study's: another device is no other search.
    stated = {**study.operating_point, **study.structure}
    return Space(
        fixed={name: value for name, value in stated.items() if name not in DEVICE},
        dimensions=dimensions,
        runs=runs,
        law=law,
        readings=readings_of(reading),
    )
