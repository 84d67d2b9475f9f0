"""The plan of a stability map as data: its parameters, ranges, lattices and starts.

A map gives outcome and alignment time from the nominal start (the device's own phase and tilt) at
every node of a fine lattice over two parameters. Near a border the outcome depends on the phase of
the excitation and on the tilt at touch-down, which cannot be controlled. A *reliable* device
therefore aligns within the horizon from all starts of an ensemble. lattice.py chooses the nodes to
compute, starts.py the starts to try.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from model.physics.parameters import Batch, Parameters, check_name
from model.runs.settings import Settings
from model.study.config.base import Axis, Plan, Span, check_plane
from model.study.config.figures import CURVES, HISTORIES, MAPS, Curves, Ensemble
from model.study.config.settings import RunSettings
from model.study.devices.batches import by_settings, devices_of, rows_of
from model.study.devices.stated import QUANTITIES, StatedDevice
from model.study.maps.lattice import Floats, Ints, Lattice
from model.study.maps.starts import starts_of

if TYPE_CHECKING:
    from model.study.config.study import Study

COARSE = 64  # smallest number of coarse cells along a side of a map
LARGEST = 8  # largest side of a coarse cell, unless that makes more than twice COARSE
LINES = 8  # squares along a side of a map; more nodes are computed on their borders
PATCH = 4  # side of the cells by which patches are found


def _quantity_name(name: str) -> str:
    check_name(name, QUANTITIES, "quantity of a device")
    return name


QuantityName = Annotated[str, AfterValidator(_quantity_name)]


class QuantitySpan(Span):
    """A range of one quantity of a device, in SI units."""

    parameter: QuantityName
    """Name of the quantity."""


class QuantityAxis(Axis):
    """Equidistant values of one quantity of a device, in SI units."""

    parameter: QuantityName
    """Name of the quantity."""


class MapPlan(Plan):
    """A map as data; the hash of its JSON is its identity.

    Attributes:
        name: "fig13", ….
        parameters: every parameter, None where it is derived; varied ones as in the baseline.
        settings: settings of the runs.
        x, y: the axes, each with cells + 1 values; cells is a power of two.
        ensemble: the starts of a reliable device, None for no ensemble.
        device: the device as its file states it, None for a dimensionless one. The axes are then
            any of its quantities, in SI units.

    Raises:
        ValueError: x and y form no lattice, are the same parameter, or break a parameter's rule.
    """

    name: str
    parameters: dict[str, float | None]
    settings: RunSettings
    x: Axis
    y: Axis
    ensemble: Ensemble | None
    device: StatedDevice | None = Field(default=None, exclude_if=lambda device: device is None)

    @model_validator(mode="after")
    def _is_a_map(self) -> "MapPlan":
        if self.x.count != self.y.count:
            raise ValueError(f"{self.x.count} and {self.y.count} nodes: must be as many")
        if self.cells & (self.cells - 1):
            raise ValueError(f"resolution = {self.cells}: must be a power of two")
        baseline, device = self.baseline, self.device
        check_plane(device.at if device else lambda v: baseline.replace(**v), self.x, self.y)
        return self

    @property
    def cells(self) -> int:
        """Finest cells along a side."""
        return self.x.count - 1

    @property
    def baseline(self) -> Parameters:
        """The parameters, with the baseline's values of the varied ones."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def metadata(self) -> dict[str, Any]:
        """Metadata of the sidecar: identity and plan."""
        return {"config_hash": self.identity, **self.model_dump(mode="json", exclude={"name"})}

    def swept(self, rows: Ints, columns: Ints) -> dict[str, Floats]:
        """Return the varied parameters at nodes, each of shape (m,)."""
        return {
            self.x.parameter: np.array(self.x.values)[columns],
            self.y.parameter: np.array(self.y.values)[rows],
        }

    def groups(
        self, rows: Ints, columns: Ints, **starts: Floats
    ) -> Iterator[tuple[Any, Batch, Settings]]:
        """Yield groups of nodes: their index into ``rows``, parameters, and settings of their runs.

        There are several groups if the horizon or depth is stated in SI units and the device's
        units vary. ``starts`` are further parameters at the nodes, each of shape (m,).
        """
        values, settings = self.swept(rows, columns), self.settings.settings
        if rows.size == 0:
            return
        if self.device is None:
            yield slice(None), Batch.of(self.baseline, **values, **starts), settings
            return
        nodes, which = np.unique(np.stack([rows, columns]), axis=1, return_inverse=True)
        batch, units = devices_of(self.device, self.swept(*nodes))
        for own, mine in by_settings(self.device, settings, units).items():
            place = np.flatnonzero(np.isin(which, mine))
            chosen = rows_of(batch, which.reshape(-1)[place]).values
            yield place, Batch({**chosen, **{n: v[place] for n, v in starts.items()}}), own

    @property
    def lattice(self) -> Lattice:
        """The lattice of the outcome from the nominal start."""
        coarse = max(self.cells // (2 * COARSE), min(self.cells // COARSE, LARGEST), 1)
        patch = PATCH if coarse > PATCH else 0  # not in small maps: a window is too large
        lines = max(self.cells // LINES, coarse)
        return Lattice(cells=self.cells, coarse=coarse, lines=lines, patch=patch, jump=1.0)

    @property
    def stride(self) -> int:
        """Finest cells along a side of a cell of the ensemble."""
        assert self.ensemble is not None  # noqa: S101  (called for maps with an ensemble)
        return self.cells // max(self.cells // self.ensemble.every, 1)

    @property
    def ensemble_lattice(self) -> Lattice:
        """The lattice of the ensemble; the nominal outcome is known at all its nodes."""
        return Lattice(cells=self.cells // self.stride, coarse=1)

    def starts(self) -> list[dict[str, float]]:
        """Return all starts of the ensemble."""
        return [] if self.ensemble is None else starts_of(self.baseline, self.ensemble)


def map_plan(study: "Study", name: str) -> MapPlan:
    """Return the map ``name`` of a study.

    Raises:
        ValueError: there is no such map.
    """
    plane = study.plane(name)
    resolution = study.maps.resolution
    return plan_of(
        name,
        study.baseline.replace(**plane.held),
        study.settings,
        (plane.x, plane.y),
        resolution.figures if name in MAPS else resolution.planes,
        study.maps.ensemble,
    )


def plan_of(
    name: str,
    parameters: Parameters,
    settings: RunSettings,
    spans: tuple[Span, Span],
    resolution: int,
    ensemble: Ensemble | None,
    device: StatedDevice | None = None,
) -> MapPlan:
    """Return a map over ``spans`` (x, y) with ``resolution`` finest cells along a side.

    The spans of a ``device`` are in SI units. A map over the phase or the initial tilt has no
    ensemble, because the ensemble varies these.

    Raises:
        ValueError: as ``MapPlan``.
    """
    type_of_axis = Axis if device is None else QuantityAxis
    x, y = (
        type_of_axis(
            parameter=span.parameter, start=span.start, stop=span.stop, count=resolution + 1
        )
        for span in spans
    )
    if {x.parameter, y.parameter} & {"phase", "initial_tilt"}:
        ensemble = None
    given = parameters.given()
    return MapPlan(
        name=name, parameters=given, settings=settings, x=x, y=y, ensemble=ensemble, device=device
    )


Mark = tuple[str, list[float], list[float]]
"""(figure, values of x, values of y): one value, or the two ends of a range."""


def marks_of(study: "Study", name: str) -> list[Mark]:
    """Return the operating points of histories and curves, as marks in the map ``name``."""
    plane = study.plane(name)
    sides = plane.x.parameter, plane.y.parameter
    marks: list[Mark] = []
    for figure in HISTORIES + CURVES:
        spec, held = study.figures[figure], study.parameters(figure)
        choices = {side: [[getattr(held, side)]] for side in sides}
        if isinstance(spec, Curves):
            choices[spec.swept.parameter] = [[spec.swept.start, spec.swept.stop]]
            choices[spec.family.parameter] = [[value] for value in spec.family.values]
        x, y = (choices[side] for side in sides)
        marks += [(figure, some_x, some_y) for some_x in x for some_y in y]
    return marks
