"""Sweeps: runs over a grid of parameters, computed in chunks and merged into one dataset.

Figures, maps, further runs of the claims and the runs of jamming are sweeps. A trajectory is a
sweep without dimensions. A map may have a second sweep in the same dataset: at every few nodes the
runs begin from all starts of an ensemble (starts.py). The same sweep and code give the same bytes:
time stamps and versions go into records.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import Field

from model.engine.results import IN_SLOT, RESULTS, UNVIBRATED_CONTROL, VALUE_TYPES
from model.events.outcomes import SUCCESSES
from model.physics.parameters import Batch, Parameters
from model.physics.units import Units
from model.runs.align import align, run_once
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.settings import Settings
from model.runs.simulate import simulate, simulate_once
from model.runs.unvibrated import unvibrated_results
from model.sweeps.axes import Axis, Family, Plan, points_of_chunk
from model.sweeps.io import (
    HISTORY_VARIABLES,
    NO_YES,
    VARIABLES,
    DatasetError,
    global_attributes,
    parameter_coordinates,
    summary_of,
)
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.starts import tilts_and_phases

Columns = Mapping[str, NDArray[Any]]
"""Variables by name: of runs, each of shape (n,), or of one trajectory over time."""

POINT = "point"
SAMPLE = "sample"  # of a trajectory: its time is no dimension, since it stands twice at a jump

_TIME = {"units": "1", "long_name": "time", "symbol": "τ"}
_DEPTH = {"units": "1", "long_name": "depth at which the part counts as inserted"}
_ATTRIBUTES = {**VARIABLES, "insertion_depth": _DEPTH}


# Results of ``align`` that ``run_once`` lacks.
_ESTIMATED = {name for name, result in RESULTS.items() if result.estimated}
START = "start_"  # begins the names of what belongs to the sweep over starts
_OF_STARTS: Mapping[str, dict[str, Any]] = {
    "reliable": {"long_name": "aligns, or goes in, from every start of the ensemble", **NO_YES},
    "margin": {
        "long_name": "distance to the nearest node that is not reliable",
        "comment": "each axis' range is the unit along it; infinite if there is no such node",
        "units": "1",
    },
}


class Group(NamedTuple):
    """Points of a sweep whose runs have the same settings.

    Attributes:
        places: which of the points asked for.
        batch: their parameter sets.
        settings: settings of their runs.
        units: the unit system of each set, None for dimensionless results.
    """

    places: NDArray[np.int64]
    batch: Batch
    settings: Settings
    units: Sequence[Units] | None = None


class Sweep(Plan):
    """Runs over a grid of no parameter to four.

    Attributes:
        name: name of the dataset: "fig06", "centred", "jamming", …; "figure" in hashes and files.
        kind: "history" (no dimensions), "curves" (family, swept) or "map" (y, x, or more).
        parameters: every parameter, None where it is derived. Swept ones have the baseline's
            values; no run uses these, but they count in the identity.
        settings: settings of the runs.
        dimensions: swept parameters, slowest first.
        variables: names of the dataset's variables of a run; no others are computed. Without those
            of errors, runs are made once.
        ensemble: starts that are tried at every few nodes of a map, None for no others.
    """

    name: str = Field(serialization_alias="figure")
    kind: Literal["history", "curves", "map"]
    parameters: dict[str, float | None]
    settings: RunSettings
    dimensions: list[Axis | Family]
    variables: tuple[str, ...] = Field(
        default=tuple(VARIABLES), exclude_if=lambda names: names == tuple(VARIABLES)
    )
    ensemble: Ensemble | None = Field(default=None, exclude_if=lambda starts: starts is None)

    @property
    def baseline(self) -> Parameters:
        """The parameters, with the baseline's values of the swept ones."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values in each dimension."""
        return tuple(len(dimension.values) for dimension in self.dimensions)

    @property
    def swept(self) -> dict[str, list[float]]:
        """Values of each swept parameter."""
        return {dimension.parameter: dimension.values for dimension in self.dimensions}

    @property
    def starts(self) -> "Sweep | None":
        """Sweep over nodes and starts: dimensions of a map, tilts, phases."""
        if self.ensemble is None:
            return None
        values = {name: each[:: self.ensemble.every] for name, each in self.swept.items()}
        values |= self.start_values(self.ensemble)
        dimensions = [Family.model_construct(parameter=n, values=v) for n, v in values.items()]
        of_starts = {"ensemble": None, "variables": ("outcome", "tau_align")}
        return self.model_copy(update={"dimensions": dimensions, **of_starts})

    def start_values(self, ensemble: Ensemble) -> dict[str, list[float]]:
        """Return the values of each parameter of the starts of an ensemble."""
        tilts, phases = tilts_and_phases(self.baseline, ensemble)
        return {"initial_tilt": list(dict.fromkeys(tilts)), "phase": phases}

    def judged(self, results: Columns, _batch: Batch) -> Columns:
        """Return the results of runs, by name, as the sweep's owner judges them."""
        return results

    @property
    def parts(self) -> dict[str, "Sweep"]:
        """This sweep, and the one over starts, by the prefix of the names of their variables."""
        return {"": self} if self.starts is None else {"": self, START: self.starts}

    @property
    def metadata(self) -> dict[str, Any]:
        """Entries of the record of a run: identity, parameters, settings, dimensions, ensemble."""
        fields = {"parameters", "settings", "dimensions", "ensemble"}
        return {"config_hash": self.identity, **self.model_dump(mode="json", include=fields)}

    def values(self, points: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
        """Return the swept parameters at flat indices ``points``, each of shape (n,)."""
        places = np.unravel_index(points, self.shape) if self.dimensions else ()
        swept = zip(self.swept.items(), places, strict=True)
        return {name: np.array(values)[place] for (name, values), place in swept}

    def batch(self, points: NDArray[np.int64]) -> Batch:
        """Return the parameter sets at flat indices ``points``."""
        return Batch.of(self.baseline, **self.values(points))

    def groups(self, points: NDArray[np.int64]) -> Iterator[Group]:
        """Yield the parameter sets at flat indices ``points``, with the settings of their runs."""
        yield Group(np.arange(points.size), self.batch(points), self.settings.settings)

    def coordinates(self) -> dict[str, Any]:
        """Return the coordinates of the dataset: swept parameters, and the others as scalars."""
        return parameter_coordinates(self.swept, self.parameters)

    def attributes(self, name: str) -> dict[str, Any]:
        """Return the attributes of a variable."""
        return _ATTRIBUTES[name]


# --- Computing ----------------------------------------------------------------------------------


def run(sweep: Sweep, chunk: int = 0, chunks: int = 1, cores: int = 1) -> xr.Dataset:
    """Run one chunk of a sweep; return its variables over ``point``, the flat index into the grid.

    Variables of a trajectory have the dimension ``sample``, those of starts ``start_point``.

    Raises:
        ValueError: ``chunk`` is not below ``chunks``.
    """
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    for prefix, part in sweep.parts.items():
        points = points_of_chunk(math.prod(part.shape), chunk, chunks)
        over, where = f"{prefix}{POINT}", {"units": "1", "long_name": "flat index into the grid"}
        coordinates[over] = (over, points, where)
        found, courses = _results(part, points, cores)
        variables |= {
            f"{prefix}{name}": (over, found[name], part.attributes(name)) for name in part.variables
        }
        variables |= {
            name: (SAMPLE, courses[name], attributes)
            for name, attributes in {"time": _TIME, **HISTORY_VARIABLES}.items()
            if courses
        }
    stated = {"figure": sweep.name, "config_hash": sweep.identity, "chunk": chunk}
    words = {
        "title": f"{sweep.name}: chunk {chunk + 1} of {chunks}",
        "summary": "Results at some points of a grid, before they are merged into its dataset.",
    }
    return xr.Dataset(variables, coordinates, {**words, **stated, "chunks": chunks})


def _results(
    sweep: Sweep, points: NDArray[np.int64], cores: int
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return ``sweep.variables`` at points as they are stored, and of a history those over time."""
    found: dict[str, NDArray[Any]] = {}
    courses: dict[str, NDArray[Any]] = {}
    for places, batch, settings, units in sweep.groups(points):
        computed, courses = _computed(sweep, batch, settings, cores)
        columns = sweep.judged(computed, batch)
        for name in sweep.variables:
            kind = VALUE_TYPES[name].stored if name in VARIABLES else np.float64
            values = columns[name]
            if units is not None and name in RESULTS:
                values = values * [each.of(RESULTS[name].quantity) for each in units]
            found.setdefault(name, np.empty(points.size, kind))[places] = values
    return found, courses


def _computed(
    sweep: Sweep, batch: Batch, settings: Settings, cores: int
) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Return ``sweep.variables`` of the runs, and for a history the variables over time."""
    wanted, tracks = {*sweep.variables}, []
    found: dict[str, NDArray[Any]] = {"insertion_depth": batch.insertion_depths()}
    courses: dict[str, NDArray[Any]] = {}
    if sweep.kind == "history":
        simulated = simulate if wanted & _ESTIMATED else simulate_once
        tracks = [simulated(batch[row], settings) for row in range(len(batch))]
    if wanted & _ESTIMATED and sweep.kind != "history":
        found |= vars(align(batch, settings, cores=cores))
    elif tracks:
        found |= {name: np.array([getattr(each, name) for each in tracks]) for name in RESULTS}
    else:
        found |= run_once(batch, settings.quickest, cores=cores)
    if sweep.kind == "history":
        courses = {"time": tracks[0].time, **tracks[0].track_variables}
    if wanted & {*UNVIBRATED_CONTROL}:
        found |= unvibrated_results(batch, settings, cores)
    if wanted & {*IN_SLOT}:
        found["insertion"] = insertion_outcomes(batch, found["outcome"], settings, cores)
    return found, courses


# --- Merging ------------------------------------------------------------------------------------


def merge(sweep: Sweep, title: str, parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the dataset of a sweep, merged from all its chunks.

    Raises:
        DatasetError: a chunk belongs to another sweep, or points are missing or occur twice.
    """
    for part in parts:
        if part.attrs.get("config_hash") != sweep.identity:
            raise DatasetError(
                f"{sweep.name}: a chunk belongs to sweep {part.attrs.get('config_hash')!r}, not "
                f"{sweep.identity!r}: delete the chunks of this figure and run again"
            )
    columns = {}
    for prefix, own in sweep.parts.items():
        size = math.prod(own.shape)
        points = np.concatenate([each[f"{prefix}{POINT}"].values for each in parts])
        if not np.array_equal(np.sort(points), np.arange(size)):
            raise DatasetError(
                f"{sweep.name}: the chunks do not hold each of {size} points once: delete the "
                "chunks of this figure and run again"
            )
        order = np.argsort(points)
        for name in (f"{prefix}{each}" for each in own.variables):
            columns[name] = np.concatenate([each[name].values for each in parts])[order]
    if sweep.kind == "history":
        columns |= {name: parts[0][name].values for name in ("time", *HISTORY_VARIABLES)}
    return dataset_of(sweep, title, columns)


def dataset_of(sweep: Sweep, title: str, columns: Columns) -> xr.Dataset:
    """Return the dataset of a sweep from columns in the order of its points."""
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    if sweep.kind == "history":
        coordinates["time"] = (SAMPLE, columns["time"], _TIME)
        for name, attributes in HISTORY_VARIABLES.items():
            variables[name] = (SAMPLE, columns[name], attributes)
    for name in sweep.variables:
        values = columns[name].reshape(sweep.shape)
        variables[name] = ([*sweep.swept], values, sweep.attributes(name))
    coordinates |= sweep.coordinates()
    if sweep.starts is not None:
        variables |= _of_starts(sweep.starts, columns)
        coordinates |= {
            f"{START}{name}": (f"{START}{name}", values, coordinates[name][2])
            for name, values in sweep.starts.swept.items()
        }
    settings = sweep.settings.settings
    summary = summary_of(
        {coordinates[name][2]["long_name"]: len(values) for name, values in sweep.swept.items()}
    )
    stated = global_attributes(sweep.name, sweep.kind, sweep.identity, title, summary, settings)
    return xr.Dataset(variables, coordinates, stated)


def _of_starts(sweep: Sweep, columns: Columns) -> dict[str, Any]:
    """Return the variables of a sweep over starts, and what they say of its nodes."""
    dims = [f"{START}{name}" for name in sweep.swept]
    variables: dict[str, Any] = {}
    for name in sweep.variables:
        attributes = sweep.attributes(name)
        words = {"long_name": f"{attributes['long_name']}, from each start"}
        values = columns[f"{START}{name}"].reshape(sweep.shape)
        variables[f"{START}{name}"] = (dims, values, attributes | words)
    goes_in = np.isin(variables[f"{START}outcome"][1], SUCCESSES)
    reliable = np.logical_and.reduce(goes_in, axis=tuple(range(2, goes_in.ndim)))
    values_of = {"reliable": reliable.astype(np.int8), "margin": margin_of(reliable)}
    return variables | {name: (dims[:2], v, _OF_STARTS[name]) for name, v in values_of.items()}


def margin_of(reliable: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return the distance of nodes to the nearest unreliable node; the range of an axis is 1."""
    if reliable.all():
        return np.full(reliable.shape, np.inf)
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415  (slow)

    spacing = [1.0 / max(count - 1, 1) for count in reliable.shape]
    return np.asarray(distance_transform_edt(reliable, sampling=spacing))
