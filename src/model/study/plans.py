"""Sweeps of the study, as the configuration states them, and the marks in its maps."""

from collections.abc import Sequence

from model.study.config.figures import CURVES, HISTORIES, Curves, History, Plane, Schematic
from model.study.config.study import Study
from model.sweeps.io import VARIABLES
from model.sweeps.sweep import TRACK_QUANTITIES, Sweep

_IN_THE_SLOT = (
    "outcome", "reason", "tau_align", "tilt_at_alignment", "sensitive", "rhs_evaluations",
    "insertion_depth",
)  # fmt: skip

Mark = tuple[str, Sequence[float], Sequence[float]]
"""(figure, values of x, values of y): one value, or the two ends of a range."""


def sweep_of(study: Study, name: str) -> Sweep:
    """Return the sweep of a figure, a map, a run of the claims, or of "jamming".

    Raises:
        ValueError: the figure is a drawing.
    """
    if name in study.claims_runs:
        run = study.claims_runs[name]
        return Sweep(
            name=name,
            kind="curves",
            parameters=study.claim_parameters(name).given(),
            settings=study.settings,
            dimensions=[run.family, run.swept],
            variables=(*VARIABLES, *TRACK_QUANTITIES),
        )
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
    return Sweep(kind="map", dimensions=[spec.y, spec.x], ensemble=study.maps.ensemble, **given)


def marks_of(study: Study, name: str) -> list[Mark]:
    """Return the operating points of histories and curves, as marks in the map ``name``."""
    plane = study.spec_of(name)
    assert isinstance(plane, Plane), name  # noqa: S101 - a map
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
