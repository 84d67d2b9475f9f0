"""Datasets of the study on disk: their attributes, and how they are written and read."""

import errno
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from enum import IntEnum
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from model.engine.results import IN_SLOT, RESULTS, TRACK_VARIABLES, UNVIBRATED_CONTROL, Result
from model.events.outcomes import Outcome
from model.physics.parameters import FIELDS
from model.physics.quantities import ANGLE, PLAIN, Quantity
from model.runs.settings import Settings
from model.sweeps.files import atomic_write, check_encoding
from model.sweeps.version import version


class DatasetError(ValueError):
    """A dataset that is unreadable, incomplete, or of another study."""


NO_YES = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "no yes"}


def flags(values: type[IntEnum]) -> dict[str, Any]:
    """Return the CF attributes of a variable whose values are members of an enumeration."""
    return {
        "flag_values": np.array([value.value for value in values], dtype=np.int8),
        "flag_meanings": " ".join(value.name.lower() for value in values),
    }


def unit_in_file(quantity: Quantity) -> str:
    """Return the CF unit of a dimensionless variable: "radian" for angles, else "1"."""
    return "radian" if quantity is ANGLE else PLAIN.unit


def result_attributes(result: Result) -> dict[str, Any]:
    """Return the attributes of the variable of a result."""
    attributes = {"units": unit_in_file(result.quantity), "long_name": result.meaning}
    if result.symbol:
        attributes["symbol"] = result.symbol
    return attributes | (flags(result.flags) if result.flags else {})


# Attributes of variables: of results of a run, and of quantities over time.
VARIABLES: Mapping[str, dict[str, Any]] = {
    name: result_attributes(result)
    for name, result in {**RESULTS, **UNVIBRATED_CONTROL, **IN_SLOT}.items()
    if result.stored
}
HISTORY_VARIABLES: Mapping[str, dict[str, Any]] = {
    name: result_attributes(result) for name, result in TRACK_VARIABLES.items() if result.stored
}


def parameter_attributes(name: str) -> dict[str, Any]:
    """Return the attributes of a parameter's coordinate."""
    field = FIELDS[name]
    units = unit_in_file(field.quantity)
    return {"long_name": field.description, "symbol": field.symbol, "units": units}


def summary_of(swept: Mapping[str, int]) -> str:
    """Return a sentence on the grid of a dataset: what is swept, in words, with its values."""
    if not swept:
        return "One run over time."
    over = " by ".join(f"{words} ({count})" for words, count in swept.items())
    return f"Results at {math.prod(swept.values())} points over {over}."


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


def global_attributes(
    name: str, kind: str, identity: str, title: str, summary: str, settings: Settings
) -> dict[str, Any]:
    """Return the global attributes of a dataset of runs; ``write_dataset`` adds those of all files.

    ``name`` and ``kind`` are such as "fig06" and "curves". ``identity`` is the hash of everything
    besides the code that determines the numbers.
    """
    depth = settings.insertion_depth
    return {
        "title": title,
        "summary": summary,
        "comment": "All quantities are dimensionless unless their units say otherwise: lengths in "
        "units of the excitation amplitude F1/K_Y, time in 1/p with p^2 = K_Y/M, forces in F1.",
        "figure": name,
        "kind": kind,
        "config_hash": identity,
        "readings": json.dumps(asdict(settings.readings)),
        "scene": settings.scene.name,
        "start": settings.start,
        **({} if depth is None else {"insertion_depth": depth}),
        **({} if settings.shape is None else {"shape": settings.shape}),
        "horizon": settings.horizon,
        "tolerance": settings.tolerance,
    }


def outcome_counts(dataset: xr.Dataset) -> dict[str, int]:
    """Return the numbers of trajectories (all, by outcome, sensitive) and of evaluations."""
    outcomes = np.atleast_1d(dataset["outcome"].values).ravel()
    counts = {each.name.lower(): int((outcomes == each).sum()) for each in Outcome}
    return {
        "trajectories": int(outcomes.size),
        **counts,
        "sensitive": int(dataset["sensitive"].values.sum()),
        "rhs_evaluations": int(dataset["rhs_evaluations"].values.sum()),
    }


def described(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset with the attributes that every file has besides its own.

    They hold no time, so that equal runs give equal bytes.
    """
    variables = {
        name: variable.assign_attrs({"coverage_content_type": "modelResult", **variable.attrs})
        for name, variable in dataset.data_vars.items()
    }
    of_every_file = {
        "Conventions": "CF-1.11, ACDD-1.3",
        "history": f"written by vibralign {version()}",
        "source": "vibralign, numerical integration of the equations of motion",
        "product_version": version(),
        "keywords": "assembly, vibration, alignment, contact, friction, simulation",
        "creator_name": "vibralign contributors",
        "creator_type": "group",
        "citation": f"vibralign contributors: vibralign, version {version()}",
        "references": "B. Bakšys, J. Baskutienė: Numerical simulation of parts alignment under "
        "kinematical excitation, Mechanika, Kaunas (2007)",
        "license": "MIT",
    }
    return dataset.assign(variables).assign_attrs(of_every_file | dataset.attrs)


def write_dataset(dataset: xr.Dataset, path: Path) -> None:
    """Write ``dataset``, ``described``, as netCDF-4.

    Raises:
        OSError: the file cannot be written; the former one then stays.
        ValueError: as ``check_encoding``.
    """
    check_encoding(path)
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        # NaN says that there is no value, such as the time of a part that does not align. CF allows
        # none in the coordinate of a dimension.
        missing = np.nan if variable.dtype.kind == "f" and name not in dataset.dims else None
        encoding[str(name)] = {"_FillValue": missing}
        if variable.ndim:
            encoding[str(name)] |= {"zlib": True, "complevel": 4, "shuffle": True}
    stored = described(dataset).copy()
    stored.attrs = as_characters(stored.attrs)
    for variable in stored.variables.values():
        variable.attrs = as_characters(variable.attrs)
    with atomic_write(path) as part:
        try:
            stored.to_netcdf(part, engine="netcdf4", format="NETCDF4", encoding=encoding)
        except (OSError, RuntimeError) as error:  # "HDF error" and the like: ask the system why
            with part.open("ab") as stream:
                stream.write(bytes(2**20))
            raise OSError(errno.EIO, str(error), str(path)) from None


def as_characters(attributes: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return attributes with texts as the bytes of their UTF-8, which are stored as characters.

    Otherwise a text beyond ASCII is stored as a string, which `ncinfo` of Octave cannot read.
    """
    return {
        name: value.encode() if isinstance(value, str) and not value.isascii() else value
        for name, value in attributes.items()
    }


def read_dataset(path: Path) -> xr.Dataset:
    """Read a dataset of the study into memory.

    Raises:
        DatasetError: the file is missing, not netCDF, truncated, or not of this study.
        ValueError: as ``check_encoding``.
    """
    check_encoding(path)
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as stored:
            dataset = stored.load()
    except (OSError, ValueError, RuntimeError) as error:
        raise DatasetError(f"{path}: cannot be read as netCDF ({error}): build it again") from None
    if "figure" not in dataset.attrs:
        raise DatasetError(f"{path}: is not a dataset of this study: build it again")
    return dataset


def read_chunks(paths: Sequence[Path], figure: str, identity: str) -> list[xr.Dataset]:
    """Read the chunks of a dataset in order.

    Wrong files are deleted with their records, so that they are made anew.

    Raises:
        DatasetError: files cannot be read, or hold other chunks; the message names them.
    """
    chunks, faults = [], {}
    for number, path in enumerate(paths):
        expected = {"figure": figure, "config_hash": identity, "chunk": number}
        expected["chunks"] = len(paths)
        try:
            chunk = read_dataset(path)
            if not expected.items() <= chunk.attrs.items():
                raise DatasetError(f"{path}: is not chunk {number} of {figure}")  # noqa: TRY301
            chunks.append(chunk)
        except DatasetError as fault:
            faults[path] = str(fault)
    for path in faults:
        path.unlink(missing_ok=True)
        path.with_suffix(".run.json").unlink(missing_ok=True)
    if faults:
        raise DatasetError(f"{'; '.join(faults.values())}; deleted: run again to compute it anew")
    return chunks
