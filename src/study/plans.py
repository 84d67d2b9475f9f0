"""Sweeps of the study, as the configuration states them."""

from typing import Any

from model.sweeps.sweep import Sweep
from study.config.figures import Jamming, Plane, Schematic
from study.config.study import Study

_IN_THE_SLOT = (
    "outcome", "reason", "tau_align", "tilt_at_alignment", "sensitive", "rhs_evaluations",
    "insertion_depth",
)  # fmt: skip


def sweep_of(study: Study, name: str) -> Sweep:
    """Return the sweep of a figure, a map, or of "jamming".

    Raises:
        ValueError: the figure is a drawing.
    """
    spec = study.jamming if name == "jamming" else study.spec_of(name)
    if isinstance(spec, Schematic):
        raise ValueError(f"{name} is a drawing: it has no sweep")  # noqa: TRY004
    settings: dict[str, Any] = {}
    more: dict[str, Any] = {}
    if isinstance(spec, Jamming):
        settings, more = {"scene": "insertion"}, {"variables": _IN_THE_SLOT}
    elif isinstance(spec, Plane):
        settings = {} if spec.shape is None else {"shape": spec.shape}
        more = {"ensemble": study.maps.ensemble}
    return Sweep(
        name=name,
        kind=getattr(spec, "kind", "map"),
        parameters=study.baseline.replace(**spec.held).given(),
        settings=study.settings.model_copy(update=settings),
        dimensions=[*spec.varied],
        **more,
    )
