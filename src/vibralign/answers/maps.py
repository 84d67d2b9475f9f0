"""Maps of a device over any two quantities of its file, in SI units."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import AfterValidator

from model.engine.results import RESULTS, UNVIBRATED_CONTROL
from model.events.scenes import ALIGNMENT
from model.physics.parameters import Batch
from model.physics.quantities import ANGLE, PLAIN
from model.runs.settings import Settings
from model.sweeps.axes import Axis, check_plane
from model.sweeps.settings import Ensemble, RunSettings
from model.sweeps.sweep import START, Columns, Group, Sweep, margin_of
from vibralign.answers.approaches import in_worst_approach
from vibralign.answers.cases import cases_of
from vibralign.answers.reliability import are_reliable
from vibralign.device.approach import SPEED
from vibralign.device.batches import by_settings, devices_of, rows_of
from vibralign.device.mouth import GRIPPER_TILT, judged
from vibralign.device.quantities import check_quantity, quantity_of
from vibralign.device.stated import StatedDevice

_VARIABLES = (
    "outcome", "reason", "tau_align", "tau_error", "sensitive", "contact_force_max",
    "rhs_evaluations", *UNVIBRATED_CONTROL,
)  # fmt: skip
_SPACES = 16  # least spaces between nodes with all starts along a side, if the map has as many


def _quantity_name(name: str) -> str:
    check_quantity(name)
    return name


class QuantityAxis(Axis):
    """Equidistant values of one quantity of a device, in SI units."""

    parameter: Annotated[str, AfterValidator(_quantity_name)]
    """Name of the quantity."""


class DeviceMap(Sweep):
    """A map over two quantities of a device.

    Attributes:
        device: the device as its file states it.
    """

    device: StatedDevice

    def start_values(self, ensemble: Ensemble) -> dict[str, list[float]]:
        """Return the tilts of the gripper, unless they are an axis, and the phases."""
        cases = cases_of(self.device, ensemble, varied=self.swept)
        names = [name for name in (GRIPPER_TILT, "phase") if name in cases[0]]
        return {name: list(dict.fromkeys(each[name] for each in cases)) for name in names}

    def judged(self, results: Columns, batch: Batch) -> Columns:
        """Return the results of runs, with those of parts that start inside the hole."""
        return judged(results, batch.values, chamfered=self.device.is_chamfered)

    def groups(self, points: NDArray[np.int64]) -> Iterator[Group]:
        """Yield the devices at points by the settings of their runs.

        A horizon or depth in SI units differs between devices of different units.
        """
        values = self.values(points)
        axes = {name: each for name, each in values.items() if name != "phase"}
        nodes, which = np.unique(np.stack([*axes.values()]), axis=1, return_inverse=True)
        batch, units = devices_of(self.device, dict(zip(axes, nodes, strict=True)))
        for own, rows in by_settings(self.device, self.settings.settings, units).items():
            places = np.flatnonzero(np.isin(which.reshape(-1), rows))
            node = which.reshape(-1)[places]
            starts = {name: each[places] for name, each in values.items() if name not in axes}
            chosen = Batch({**rows_of(batch, node).values, **starts})
            yield Group(places, chosen, own, [units[each] for each in node])

    def coordinates(self) -> dict[str, Any]:
        """Return the axes, and as scalars the quantities that no axis changes; in SI units."""
        axes = {axis.parameter: axis.values for axis in self.dimensions[:2]}
        held = held_at_corners(self.device, axes)
        coordinates = {name: ((), v, quantity_attributes(name)) for name, v in held.items()}
        swept = {name: (name, v, quantity_attributes(name)) for name, v in self.swept.items()}
        return dict(sorted((coordinates | swept).items()))

    def attributes(self, name: str) -> dict[str, Any]:
        """Return the attributes of a variable, with its SI unit."""
        attributes = super().attributes(name)
        if name in RESULTS and RESULTS[name].quantity not in (ANGLE, PLAIN):
            attributes = attributes | {"units": RESULTS[name].quantity.unit}
        return attributes


def in_every_case(
    found: xr.Dataset,
    device: StatedDevice,
    settings: Settings,
    ensemble: Ensemble,
    cores: int = 1,
) -> xr.Dataset:
    """Return a map whose reliable nodes are reliable in every case that ``assess`` tries.

    A map tries one approach and one base. Nodes that are reliable there are tried with all others.
    """
    if "reliable" not in found:
        return found
    reliable = found["reliable"].values.astype(bool)
    axes = {str(dim).removeprefix(START): found[dim].values for dim in found["reliable"].dims}
    cases = cases_of(device, ensemble, varied=axes)
    if len(cases) * reliable.size == found["start_outcome"].size or not reliable.any():
        return found
    places = np.nonzero(reliable)
    values = {name: each[at] for (name, each), at in zip(axes.items(), places, strict=True)}
    reliable[places] = are_reliable(device, values, cases, settings, cores)
    words = f"in each of {len(cases)} cases: starts, approaches and bases"
    columns = {"reliable": reliable.astype(np.int8), "margin": margin_of(reliable)}
    attributes = {"reliable": {"comment": words}, "margin": {}}
    return found.assign(
        {
            name: (found[name].dims, column, found[name].attrs | attributes[name])
            for name, column in columns.items()
        }
    )


def corners_of(axes: Mapping[str, Sequence[float]]) -> list[dict[str, float]]:
    """Return the corners of a grid: the first or last value of each axis, by name."""
    ends = [dict.fromkeys((values[0], values[-1])) for values in axes.values()]
    return [dict(zip(axes, each, strict=True)) for each in itertools.product(*ends)]


def held_at_corners(device: StatedDevice, axes: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Return the quantities of a device that are the same at all corners of a grid."""
    corners = [device.changed(**each).values for each in corners_of(axes)]
    return {n: v for n, v in corners[0].items() if all(c.get(n) == v for c in corners)}


def quantity_attributes(name: str) -> dict[str, Any]:
    """Return the attributes of the coordinate of a device's quantity, in SI units."""
    words, quantity, symbol = quantity_of(name)
    is_angle = quantity is ANGLE  # CF's word differs from the SI symbol
    attributes = {"long_name": words, "units": "radian" if is_angle else quantity.unit}
    return attributes | ({"symbol": symbol} if symbol else {})


def map_of(
    device: StatedDevice,
    settings: RunSettings,
    axes: tuple[QuantityAxis, QuantityAxis],
    ensemble: Ensemble,
    cores: int = 1,
) -> DeviceMap:
    """Return a map of a device over two axes, x and y, in SI units.

    The starts of the ensemble are tried at every node of a coarse map, at most as far apart as in
    the ensemble. A map over the phase tries none. A device that states no
    approach is mapped with the worst at its own values (``in_worst_approach``), on the base of a
    single run; ``in_every_case`` tries the others.

    Raises:
        ValueError: the axes have the same parameter, or break a parameter's rule.
    """
    x, y = axes
    varied = {x.parameter, y.parameter}
    stated = (
        device.lowered(device.approaches(varied)[0])
        if SPEED in varied and not device.sudden
        else in_worst_approach(device, settings.settings, ensemble, cores)
    )
    own = stated.run_settings(settings.settings, stated.units)
    changes = {"start": own.start} | ({"scene": ALIGNMENT.name} if stated.is_chamfered else {})
    check_plane(stated.at, x, y)
    for each in corners_of({axis.parameter: [*axis.values] for axis in axes}):
        stated.warn(each)
    every = max(min(ensemble.every, (min(x.count, y.count) - 1) // _SPACES), 1)
    return DeviceMap(
        name="map",
        kind="map",
        parameters=stated.parameters.given(),
        settings=settings.model_copy(update=changes),
        dimensions=[y, x],
        variables=_VARIABLES,
        ensemble=None if "phase" in varied else ensemble.model_copy(update={"every": every}),
        device=stated,
    )
