"""The study's datasets: chunks of a sweep, merged into one netCDF file a figure.

Content is deterministic: the same sweep and code give the same bytes. Time stamps, versions and the
like go into sidecars (provenance.py).
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from model.engines.results import (
    IN_SLOT,
    KINDS,
    RESULTS,
    TRACK_VARIABLES,
    UNVIBRATED_CONTROL,
    Result,
)
from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS, Batch
from model.physics.quantities import ANGLE
from model.runs.align import align
from model.runs.insertion_outcome import insertion_outcomes
from model.runs.settings import Settings
from model.runs.simulate import simulate
from model.runs.unvibrated import unvibrated_results
from model.study.files import whole_file
from model.study.sweeps import Sweep

POINT = "point"
_LARGE = 2**16  # values of a grid that is stored in pieces


class DatasetError(ValueError):
    """A dataset that is unreadable, incomplete, or of another study."""


def discard(faults: Mapping[Path, str]) -> None:
    """Delete the parts in which ``faults`` were found, with their sidecars.

    Raises:
        DatasetError: the faults, if there are any.
    """
    for path in faults:
        path.unlink(missing_ok=True)
        path.with_suffix(".run.json").unlink(missing_ok=True)
    if faults:
        raise DatasetError(f"{'; '.join(faults.values())}; deleted: run again to compute it anew")


def flags(values: type[IntEnum]) -> dict[str, Any]:
    """Return the CF attributes of a variable that holds values of an enumeration."""
    return {
        "flag_values": np.array([value.value for value in values], dtype=np.int8),
        "flag_meanings": " ".join(value.name.lower() for value in values),
    }


def _attributes(result: Result) -> dict[str, Any]:
    """Return the attributes of a variable that holds a result."""
    attributes = {"units": "rad" if result.quantity is ANGLE else "1", "long_name": result.meaning}
    if result.symbol:
        attributes["symbol"] = result.symbol
    return attributes | (flags(result.flags) if result.flags else {})


# Attributes of the results that datasets hold, and of the course of a trajectory.
VARIABLES: Mapping[str, dict[str, Any]] = {
    name: _attributes(result)
    for name, result in {**RESULTS, **UNVIBRATED_CONTROL, **IN_SLOT}.items()
    if result.stored
}
HISTORY_VARIABLES: Mapping[str, dict[str, Any]] = {
    name: _attributes(result) for name, result in TRACK_VARIABLES.items() if result.stored
}


def parameter_attributes(name: str) -> dict[str, Any]:
    """Return the attributes of a parameter's coordinate."""
    field = FIELDS[name]
    return {"long_name": field.description, "symbol": field.symbol, "units": "1"}


def compute_chunk(sweep: Sweep, chunk: int, chunks: int, cores: int = 1) -> xr.Dataset:
    """Run one chunk of a sweep; its variables lie over ``point``, the flat index into the grid."""
    points = sweep.points_of_chunk(chunk, chunks)
    batch, settings = sweep.batch(points), sweep.settings.settings
    found = align(batch, settings, cores=cores)
    results = vars(found) | unvibrated_results(batch, settings, cores)
    results["insertion"] = insertion_outcomes(batch, found.outcome, settings, cores)
    return xr.Dataset(
        {name: (POINT, results[name].astype(KINDS[name].stored)) for name in VARIABLES},
        coords={POINT: points},
        attrs={"figure": sweep.figure, "sweep": sweep.identity, "chunk": chunk, "chunks": chunks},
    )


def merge_chunks(sweep: Sweep, title: str, summary: str, parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Return the figure's dataset, merged from all chunks of its sweep.

    Raises:
        DatasetError: a chunk of another sweep, or points that are missing or occur twice.
    """
    for part in parts:
        if part.attrs.get("sweep") != sweep.identity:
            raise DatasetError(
                f"{sweep.figure}: a chunk belongs to sweep {part.attrs.get('sweep')!r}, not "
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
    names = [dimension.parameter for dimension in sweep.dimensions]
    variables = {}
    for name, attributes in VARIABLES.items():
        flat = np.concatenate([part[name].values for part in parts])[order]
        variables[name] = (names, flat.reshape(sweep.shape), attributes)
    return xr.Dataset(variables, _coordinates(sweep), _global(sweep, title, summary))


def history_dataset(sweep: Sweep, title: str, summary: str) -> xr.Dataset:
    """Return one trajectory over time, with its results as scalars."""
    run = simulate(sweep.baseline, sweep.settings.settings)
    variables: dict[str, Any] = {
        name: ("time", run.track_variables[name], known)
        for name, known in HISTORY_VARIABLES.items()
    }
    batch, settings = Batch.stack([sweep.baseline]), sweep.settings.settings
    columns = unvibrated_results(batch, settings)
    columns["insertion"] = insertion_outcomes(batch, np.array([run.outcome], np.int8), settings)
    results = vars(run) | {name: column[0] for name, column in columns.items()}
    for name, attributes in VARIABLES.items():
        value = np.asarray(results[name])
        one_byte = KINDS[name].stored is np.int8
        variables[name] = ((), value.astype(np.int8) if one_byte else value, attributes)
    time = ("time", run.time, {"units": "1", "long_name": "time", "symbol": "τ"})
    coordinates = {"time": time, **_coordinates(sweep)}
    return xr.Dataset(variables, coordinates, _global(sweep, title, summary))


def parameter_coordinates(
    swept: Mapping[str, Sequence[float]], parameters: Mapping[str, float | None]
) -> dict[str, Any]:
    """Return ``swept`` as dimension coordinates, the other ``parameters`` as scalar ones."""
    coordinates: dict[str, Any] = {
        name: (name, values, parameter_attributes(name)) for name, values in swept.items()
    }
    for name, value in parameters.items():
        if name in swept:
            continue
        attributes = parameter_attributes(name)
        if value is None:
            attributes["comment"] = f"NaN stands for {FIELDS[name].derived}"
        coordinates[name] = ((), np.nan if value is None else value, attributes)
    return coordinates


def _coordinates(sweep: Sweep) -> dict[str, Any]:
    swept = {dimension.parameter: dimension.values for dimension in sweep.dimensions}
    return parameter_coordinates(swept, sweep.parameters)


def global_attributes(
    name: str, kind: str, identity: str, title: str, summary: str, settings: Settings
) -> dict[str, Any]:
    """Return the global attributes that every dataset of the study has.

    ``name``, ``kind`` and ``identity`` tell which computation it holds: "fig06", "curves", and the
    hash of all that its numbers depend on besides the code.
    """
    depth = settings.insertion_depth
    return {
        "Conventions": "CF-1.11 ACDD-1.3",
        "title": title,
        "summary": summary,
        "source": "vibralign, numerical integration of the equations of motion",
        "references": "Numerical simulation of parts alignment under kinematical excitation, "
        "Mechanika (2007)",
        "license": "MIT",
        "comment": "All quantities are dimensionless unless their units say otherwise: lengths in "
        "units of the excitation amplitude F1/K_Y, time in 1/p with p^2 = K_Y/M, forces in F1.",
        "figure": name,
        "kind": kind,
        "sweep": identity,
        "readings": json.dumps(asdict(settings.readings)),
        "scene": settings.scene.name,
        **({} if depth is None else {"insertion_depth": depth}),
        "horizon": settings.horizon,
        "tolerance": settings.tolerance,
    }


def _global(sweep: Sweep, title: str, summary: str) -> dict[str, Any]:
    settings = sweep.settings.settings
    return global_attributes(sweep.figure, sweep.kind, sweep.identity, title, summary, settings)


def outcome_counts(dataset: xr.Dataset) -> dict[str, int]:
    """Count the trajectories of a dataset by outcome, the sensitive ones, and evaluations."""
    outcomes = np.atleast_1d(dataset["outcome"].values).ravel()
    counts = {each.name.lower(): int((outcomes == each).sum()) for each in Outcome}
    return {
        "trajectories": int(outcomes.size),
        **counts,
        "sensitive": int(dataset["sensitive"].values.sum()),
        "rhs_evaluations": int(dataset["rhs_evaluations"].values.sum()),
    }


def write_dataset(dataset: xr.Dataset, path: Path) -> None:
    """Write ``dataset`` as netCDF-4, whole or not at all.

    Raises:
        OSError: the folder cannot be written.
    """
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        # NaN is data (the part does not align), never a fill value.
        encoding[str(name)] = {"_FillValue": None}
        if variable.ndim:
            encoding[str(name)] |= {"zlib": True, "complevel": 4, "shuffle": True}
        if variable.ndim == 2 and variable.size > _LARGE:
            encoding[str(name)] |= {"chunksizes": tuple(min(n, 256) for n in variable.shape)}
    with whole_file(path) as part:
        dataset.to_netcdf(part, engine="netcdf4", format="NETCDF4", encoding=encoding)


def read_dataset(path: Path) -> xr.Dataset:
    """Read a dataset of the study into memory.

    Raises:
        DatasetError: a file that is missing, not netCDF, truncated, or not of this study.
    """
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as stored:
            dataset = stored.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise DatasetError(f"{path}: cannot be read as netCDF ({error}): build it again") from None
    if "figure" not in dataset.attrs or "sweep" not in dataset.attrs:
        raise DatasetError(f"{path}: is not a dataset of this study: build it again")
    return dataset
