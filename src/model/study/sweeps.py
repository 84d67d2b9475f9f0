"""The computation behind a figure: a grid over one or two parameters, or one trajectory."""

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch, Parameters
from model.study.config.base import Axis, Family
from model.study.config.settings import RunSettings
from model.study.plan import Plan

if TYPE_CHECKING:
    from model.study.config.study import Study


class Sweep(Plan):
    """The computation of one figure.

    Attributes:
        figure: "fig06", ….
        kind: "history" (no dimensions), "curves" (family, swept) or "map" (y, x).
        parameters: every parameter, None where it is derived. The baseline's values of the swept
            ones are overridden, but remain in the identity, which every stored dataset carries.
        settings: settings of the runs.
        dimensions: swept parameters, slowest first.
    """

    figure: str
    kind: Literal["history", "curves", "map"]
    parameters: dict[str, float | None]
    settings: RunSettings
    dimensions: list[Axis | Family]

    @property
    def baseline(self) -> Parameters:
        """The held parameters, with the baseline's values of the swept ones."""
        return Parameters(**self.parameters)  # type: ignore[arg-type]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values in each dimension."""
        return tuple(len(dimension.values) for dimension in self.dimensions)

    @property
    def facts(self) -> dict[str, Any]:
        """The computation as its sidecar states it."""
        stated = self.model_dump(mode="json", include={"parameters", "settings", "dimensions"})
        return {"sweep": self.identity, **stated}

    def points_of_chunk(self, chunk: int, chunks: int) -> NDArray[np.int64]:
        """Return the flat indices of a chunk: every ``chunks``-th point, so that chunks cost alike.

        Raises:
            ValueError: a chunk that is not one of ``chunks``.
        """
        if not 0 <= chunk < chunks:
            raise ValueError(f"chunk = {chunk}: must be 0 to {chunks - 1}")
        return np.arange(chunk, int(np.prod(self.shape)), chunks, dtype=np.int64)

    def batch(self, points: NDArray[np.int64]) -> Batch:
        """Return the parameter sets at flat indices ``points``."""
        places = np.unravel_index(points, self.shape)
        swept = {
            dimension.parameter: np.array(dimension.values)[place]
            for dimension, place in zip(self.dimensions, places, strict=True)
        }
        return Batch.of(self.baseline, **swept)


def sweep_of(study: "Study", figure: str) -> Sweep:
    """Return the sweep of a figure.

    Raises:
        ValueError: a figure that computes nothing.
    """
    spec = study.figures[figure]
    dimensions: list[Axis | Family] = []
    if spec.kind == "curves":
        dimensions = [spec.family, spec.swept]
    elif spec.kind == "map":
        dimensions = [spec.y, spec.x]
    elif spec.kind == "schematic":
        raise ValueError(f"{figure} is a drawing: it has no sweep")
    return Sweep(
        figure=figure,
        kind=spec.kind,
        parameters=study.parameters(figure).given(),
        settings=study.settings,
        dimensions=dimensions,
    )


def claim_sweep(study: "Study", name: str) -> Sweep:
    """Return the sweep of ``study.claims_runs[name]``."""
    spec = study.claims_runs[name]
    return Sweep(
        figure=name,
        kind="curves",
        parameters=study.claim_parameters(name).given(),
        settings=study.settings,
        dimensions=[spec.family, spec.swept],
    )
