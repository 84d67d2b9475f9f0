"""Sweeps: runs over a grid of parameters, computed in chunks and merged into one dataset.

Figures, further runs of the claims and the runs of jamming are sweeps; ``sweep_of`` reads them from
the configuration. A trajectory is a sweep without dimensions. The same sweep and code give the same
bytes: time stamps and versions go into sidecars.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import Field

from model.engines.results import IN_SLOT, RESULTS, UNVIBRATED_CONTROL, VALUE_TYPES
from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.runs.align import align
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.simulate import Trajectory, simulate
from model.runs.unvibrated import unvibrated_results
from model.study.config.base import Axis, Family, Plan, points_of_chunk
from model.study.config.settings import RunSettings
from model.study.io import (
    HISTORY_VARIABLES,
    VARIABLES,
    DatasetError,
    global_attributes,
    parameter_coordinates,
    summary_of,
)

if TYPE_CHECKING:
    from model.study.config.study import Study

Columns = Mapping[str, NDArray[Any]]
"""Variables by name: of runs, each of shape (n,), or of one trajectory over time."""

POINT = "point"
SAMPLE = "sample"  # of a trajectory: its time is no dimension, since it stands twice at a jump

# Quantities of a trajectory for claims on displacement and rest.
TRACK_QUANTITIES: Mapping[str, dict[str, Any]] = {
    "tilt_end": {
        "units": "radian",
        "long_name": "tilt at the end, mean over the last excitation period",
        "symbol": "φ",
    },
    "way": {
        "units": "1",
        "long_name": "share of the way to the slot that the edge has slid along the bottom face at "
        "the end, mean over the last excitation period",
    },
    "excursion": {
        "units": "1",
        "long_name": "largest distance of x from its start until alignment",
    },
    "side_force_max": {
        "units": "1",
        "long_name": "largest force of A2 on the side face until alignment",
    },
}
_TIME = {"units": "1", "long_name": "time", "symbol": "τ"}
_DEPTH = {"units": "1", "long_name": "depth at which the part counts as inserted"}
_ATTRIBUTES = {**VARIABLES, **TRACK_QUANTITIES, "insertion_depth": _DEPTH}
_IN_THE_SLOT = (
    "outcome", "reason", "tau_align", "tilt_at_alignment", "sensitive", "rhs_evaluations",
    "insertion_depth",
)  # fmt: skip
_STATIC = 1.0  # time over which the end is averaged without an excitation


class Sweep(Plan):
    """Runs over a grid of no parameter to three.

    Attributes:
        figure: name of the dataset: "fig06", "centred", "jamming", ….
        kind: "history" (no dimensions), "curves" (family, swept) or "map" (y, x, or three).
        parameters: every parameter, None where it is derived. Swept ones have the baseline's
            values; no run uses these, but they count in the identity.
        settings: settings of the runs.
        dimensions: swept parameters, slowest first.
        variables: names of the dataset's variables of a run; no others are computed.
    """

    figure: str
    kind: Literal["history", "curves", "map"]
    parameters: dict[str, float | None]
    settings: RunSettings
    dimensions: list[Axis | Family]
    variables: tuple[str, ...] = Field(
        default=tuple(VARIABLES), exclude_if=lambda names: names == tuple(VARIABLES)
    )

    @property
    def baseline(self) -> Parameters:
        """The parameters, with the baseline's values of the swept ones."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values in each dimension."""
        return tuple(len(dimension.values) for dimension in self.dimensions)

    @property
    def metadata(self) -> dict[str, Any]:
        """Metadata of the sidecar: identity, parameters, settings, dimensions."""
        stated = self.model_dump(mode="json", include={"parameters", "settings", "dimensions"})
        return {"config_hash": self.identity, **stated}

    def batch(self, points: NDArray[np.int64]) -> Batch:
        """Return the parameter sets at flat indices ``points``."""
        places = np.unravel_index(points, self.shape) if self.dimensions else ()
        swept = {
            dimension.parameter: np.array(dimension.values)[place]
            for dimension, place in zip(self.dimensions, places, strict=True)
        }
        return Batch.of(self.baseline, **swept)


def sweep_of(study: "Study", name: str) -> Sweep:
    """Return the sweep of a figure, of a run of the claims, or of "jamming".

    Raises:
        ValueError: the figure is a drawing.
    """
    if name in study.claims_runs:
        run = study.claims_runs[name]
        return Sweep(
            figure=name,
            kind="curves",
            parameters=study.claim_parameters(name).given(),
            settings=study.settings,
            dimensions=[run.family, run.swept],
            variables=(*VARIABLES, *TRACK_QUANTITIES),
        )
    if name == "jamming":
        slot = study.jamming
        return Sweep(
            figure=name,
            kind="map",
            parameters=study.baseline.replace(**slot.held).given(),
            settings=study.settings.model_copy(update={"scene": "insertion"}),
            dimensions=[slot.clearance, slot.tilt_stiffness, slot.friction],
            variables=_IN_THE_SLOT,
        )
    spec = study.figures[name]
    dimensions: list[Axis | Family] = []
    if spec.kind == "schematic":
        raise ValueError(f"{name} is a drawing: it has no sweep")
    if spec.kind == "curves":
        dimensions = [spec.family, spec.swept]
    elif spec.kind == "map":
        dimensions = [spec.y, spec.x]
    return Sweep(
        figure=name,
        kind=spec.kind,
        parameters=study.parameters(name).given(),
        settings=study.settings,
        dimensions=dimensions,
    )


# --- Computing ----------------------------------------------------------------------------------


def run(sweep: Sweep, chunk: int = 0, chunks: int = 1, cores: int = 1) -> xr.Dataset:
    """Run one chunk of a sweep; return its variables over ``point``, the flat index into the grid.

    Variables of a trajectory have the dimension ``sample``.

    Raises:
        ValueError: ``chunk`` is not below ``chunks``.
    """
    points = points_of_chunk(int(np.prod(sweep.shape)), chunk, chunks)
    found = _computed(sweep, sweep.batch(points), cores)
    variables: dict[str, Any] = {
        name: (
            POINT,
            found[name].astype(VALUE_TYPES[name].stored if name in VARIABLES else np.float64),
            _ATTRIBUTES[name],
        )
        for name in sweep.variables
    }
    if sweep.kind == "history":
        variables |= {
            name: (SAMPLE, found[name], attributes)
            for name, attributes in {"time": _TIME, **HISTORY_VARIABLES}.items()
        }
    stated = {"figure": sweep.figure, "config_hash": sweep.identity, "chunk": chunk}
    words = {
        "title": f"{sweep.figure}: chunk {chunk + 1} of {chunks}",
        "summary": "Results at some points of a grid, before they are merged into its dataset.",
    }
    where = {"units": "1", "long_name": "flat index into the grid"}
    return xr.Dataset(
        variables, {POINT: (POINT, points, where)}, {**words, **stated, "chunks": chunks}
    )


def _computed(sweep: Sweep, batch: Batch, cores: int) -> dict[str, NDArray[Any]]:
    """Return ``sweep.variables`` of the runs, and for a history the variables over time."""
    settings, wanted = sweep.settings.settings, {*sweep.variables}
    tracks = []
    if sweep.kind == "history" or wanted & {*TRACK_QUANTITIES}:
        tracks = [simulate(batch[row], settings) for row in range(len(batch))]
    if sweep.kind == "history":
        (track,) = tracks
        found = {name: np.array([getattr(track, name)]) for name in RESULTS}
        found |= {"time": track.time, **track.track_variables}
    else:
        found = dict(vars(align(batch, settings, cores=cores)))
    if wanted & {*UNVIBRATED_CONTROL}:
        found |= unvibrated_results(batch, settings, cores)
    if wanted & {*IN_SLOT}:
        found["insertion"] = insertion_outcomes(batch, found["outcome"], settings, cores)
    if wanted & {*TRACK_QUANTITIES}:
        rows = [_of_track(track) for track in tracks]
        found |= {name: np.array([row[name] for row in rows]) for name in TRACK_QUANTITIES}
    return {**found, "insertion_depth": batch.insertion_depths()}


def _of_track(track: Trajectory) -> dict[str, float]:
    """Return ``TRACK_QUANTITIES`` of a trajectory."""
    aligned = track.outcome == Outcome.ALIGNED
    until = track.time <= (track.tau_align if aligned else np.inf)
    time, state = track.time[until], track.state[until]
    x, y, tilt = state[:, 0], state[:, 1], state[:, 2]
    device = track.parameters
    arm = (device.slot_half_width - x) * np.cos(tilt) - y * np.sin(tilt)
    # s in the paper's frame: the edge is at s on the bottom face and leaves it at s = a.
    slid = (arm - arm[0]) / (device.half_width - arm[0])
    period = 2.0 * np.pi / device.frequency if device.frequency > 0.0 else _STATIC
    last = time >= time[-1] - period
    return {
        "tilt_end": _mean(time[last], tilt[last]),
        "way": 1.0 if aligned else _mean(time[last], slid[last]),
        "excursion": float(np.abs(x - x[0]).max()),
        "side_force_max": float(track.side_force[until].max()),
    }


def _mean(time: NDArray[np.float64], values: NDArray[np.float64]) -> float:
    """Return the mean over time of values at unevenly spaced times."""
    length = float(time[-1] - time[0])
    if length <= 0.0:
        return float(values[-1])
    return float(np.trapezoid(values, time) / length)


# --- Merging ------------------------------------------------------------------------------------


def merge(sweep: Sweep, title: str, parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the dataset of a sweep, merged from all its chunks.

    Raises:
        DatasetError: a chunk belongs to another sweep, or points are missing or occur twice.
    """
    for part in parts:
        if part.attrs.get("config_hash") != sweep.identity:
            raise DatasetError(
                f"{sweep.figure}: a chunk belongs to sweep {part.attrs.get('config_hash')!r}, not "
                f"{sweep.identity!r}: delete the chunks of this figure and run again"
            )
    size = int(np.prod(sweep.shape))
    points = np.concatenate([part[POINT].values for part in parts])
    if not np.array_equal(np.sort(points), np.arange(size)):
        raise DatasetError(
            f"{sweep.figure}: the chunks do not hold each of {size} points once: delete the "
            "chunks of this figure and run again"
        )
    order = np.argsort(points)
    columns = {
        name: np.concatenate([part[name].values for part in parts])[order]
        for name in sweep.variables
    }
    if sweep.kind == "history":
        columns |= {name: parts[0][name].values for name in ("time", *HISTORY_VARIABLES)}
    return dataset_of(sweep, title, columns)


def dataset_of(sweep: Sweep, title: str, columns: Columns) -> xr.Dataset:
    """Return the dataset of a sweep from columns in the order of its points."""
    swept = {dimension.parameter: dimension.values for dimension in sweep.dimensions}
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    if sweep.kind == "history":
        coordinates["time"] = (SAMPLE, columns["time"], _TIME)
        for name, attributes in HISTORY_VARIABLES.items():
            variables[name] = (SAMPLE, columns[name], attributes)
    for name in sweep.variables:
        variables[name] = ([*swept], columns[name].reshape(sweep.shape), _ATTRIBUTES[name])
    coordinates |= parameter_coordinates(swept, sweep.parameters)
    settings = sweep.settings.settings
    summary = summary_of({name: len(values) for name, values in swept.items()})
    stated = global_attributes(sweep.figure, sweep.kind, sweep.identity, title, summary, settings)
    return xr.Dataset(variables, coordinates, stated)
