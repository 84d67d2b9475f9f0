"""Sweeps of the study, as the configuration states them."""

from model.sweeps.sweep import Sweep
from study.config.figures import Curves, History, Schematic
from study.config.study import Study

_IN_THE_SLOT = (
    "outcome", "reason", "tau_align", "tilt_at_alignment", "sensitive", "rhs_evaluations",
    "insertion_depth",
)  # fmt: skip


def sweep_of(study: Study, name: str) -> Sweep:
    """Return the sweep of a figure, a map, a run of the claims, or of "jamming".

    Raises:
        ValueError: the figure is a drawing.
    """
    if name == "jamming":
        slot = study.jamming
        return Sweep(
            name=name,
            kind="map",
            parameters=study.baseline.replace(**slot.held).given(),
            settings=study.settings.model_copy(update={"scene": "insertion"}),
            dimensions=[slot.clearance, slot.tilt_stiffness, slot.friction],
            variables=_IN_THE_SLOT,
        )
    spec = study.spec_of(name)
    given = {"name": name, "settings": study.settings}
    given["parameters"] = study.parameters(name).given()
    if isinstance(spec, Schematic):
        raise ValueError(f"{name} is a drawing: it has no sweep")  # noqa: TRY004
    if isinstance(spec, History):
        return Sweep(kind="history", dimensions=[], **given)
    if isinstance(spec, Curves):
        return Sweep(kind="curves", dimensions=[spec.family, spec.swept], **given)
    if spec.shape is not None:
        given["settings"] = study.settings.model_copy(update={"shape": spec.shape})
    return Sweep(kind="map", dimensions=[spec.y, spec.x], ensemble=study.maps.ensemble, **given)
