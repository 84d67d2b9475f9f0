"""Rules that need the whole study, such as those of parameters whose values are in two sections."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial

from model.physics.parameters import FIELDS, REQUIRED_NAMES, Batch, Parameters, check_name
from model.study.config.base import Axis, Family, Span, check_plane
from model.study.config.figures import COMPUTED, KIND, Curves, Map, Plane
from model.study.config.study import Study


def faults_of(study: Study) -> list[str]:
    """Return a line for every fault that only the whole study shows: path, value and rule."""
    faults = [*_values(study)]
    if not faults:
        for check in (_ranges, _figures, _planes, _claims_runs, _jamming, _cases):
            faults += check(study)
    return faults


def _broken(place: str, values: Mapping[str, float]) -> Iterable[str]:
    """Yield a line for each value that breaks the rule of its parameter."""
    for name, value in values.items():
        if not FIELDS[name].admits(value):
            yield f"{place}.{name} = {value!r}: {FIELDS[name].rule}"


def _attempt(place: str, action: Callable[[], object]) -> Iterable[str]:
    """Call ``action`` and yield a line with its refusal, if it raises one."""
    try:
        action()
    except (TypeError, ValueError) as error:
        yield f"{place}: {error}"


def _varied(
    place: str, what: str, parts: Iterable[Span | Family], held: Iterable[str]
) -> Iterable[str]:
    """Yield a line for each parameter that is varied twice, or both held and varied."""
    names = [part.parameter for part in parts]
    if len(set(names)) < len(names):
        yield f"{place}: {names[0]!r} is varied twice"
    for each in sorted(set(names) & set(held)):
        yield f"{place}.held.{each}: is varied in the same {what}"


def _values(study: Study) -> Iterable[str]:
    yield from _broken("structure", study.structure)
    yield from _broken("operating_point", study.operating_point)
    for name in REQUIRED_NAMES:
        if name not in study.structure and name not in study.operating_point:
            yield f"structure.{name}: missing ({FIELDS[name].description})"
    for name, figure in study.figures.items():
        yield from _broken(f"figures.{name}.held", figure.held)


def _ranges(study: Study) -> Iterable[str]:
    """Yield the faults of the ranges of the accuracy trial."""
    place, ranges = "accuracy.ranges", study.accuracy.ranges
    ends = [{name: law.low for name, law in ranges.items()}]
    ends.append({name: 0.0 for name, law in ranges.items() if law.zero > 0.0})
    faults = [fault for values in ends for fault in _broken(place, values)]
    if not faults:
        # The worst combination of the ends: the farthest start on the narrowest part.
        narrow = {"half_width", "clearance"}
        worst = {name: law.low if name in narrow else law.high for name, law in ranges.items()}
        faults += _attempt(place, lambda: study.baseline.replace(**worst))
    return faults


def _figures(study: Study) -> Iterable[str]:
    for name, figure in study.figures.items():
        place = f"figures.{name}"
        if figure.kind != KIND[name]:
            yield f"{place}.kind = {figure.kind!r}: must be {KIND[name]!r}"
        varied: dict[str, Axis | Family] = {}
        if isinstance(figure, Curves):
            varied = {"swept": figure.swept, "family": figure.family}
        elif isinstance(figure, Map):
            varied = {"x": figure.x, "y": figure.y}
        yield from _varied(place, "figure", varied.values(), figure.held)
        refused = list(_attempt(f"{place}.held", partial(study.parameters, name)))
        yield from refused
        if not refused:
            for key, part in varied.items():
                yield from _attempt(f"{place}.{key}", _batch(study.parameters(name), part))


def _batch(parameters: Parameters, part: Axis | Family) -> Callable[[], object]:
    return partial(Batch.of, parameters, **{part.parameter: part.values})


def _planes(study: Study) -> Iterable[str]:
    for name in study.map_names:
        plane = study.plane(name)
        if isinstance(plane, Map):  # a figure's: checked there
            continue
        place = f"maps.planes.{name}"
        yield from _varied(place, "map", (plane.x,), plane.held)
        yield from _varied(place, "map", (plane.y,), plane.held)
        yield from _attempt(place, partial(_plane, study, plane))


def _plane(study: Study, plane: Plane) -> None:
    held = study.baseline.replace(**plane.held)
    check_plane(lambda values: held.replace(**values), plane.x, plane.y)


def _claims_runs(study: Study) -> Iterable[str]:
    for name, run in study.claims_runs.items():
        place = f"claims_runs.{name}"
        yield from _varied(place, "run", (run.swept, run.family), run.held)
        yield from _attempt(place, partial(_claims_run, study, name))


def _jamming(study: Study) -> Iterable[str]:
    spec = study.jamming
    parts = (spec.clearance, spec.tilt_stiffness, spec.friction)
    yield from _varied("jamming", "figure", parts, spec.held)
    for part in parts:
        yield from _attempt("jamming", _batch(study.baseline.replace(**spec.held), part))


def _claims_run(study: Study, name: str) -> None:
    run = study.claims_runs[name]
    check_name(run.figure, COMPUTED, "figure")
    for part in (run.family, run.swept):
        _batch(study.claim_parameters(name), part)()


def _cases(study: Study) -> Iterable[str]:
    for name, case in study.precision.cases.items():
        place = f"precision.cases.{name}"
        refused = list(_attempt(place, partial(check_name, case.figure, COMPUTED, "figure")))
        yield from refused or _attempt(place, partial(study.case, name))
    for name, hard in study.hard_cases.all_cases.items():
        action = partial(study.baseline.replace, **hard.at)
        yield from _attempt(f"hard_cases.cases.{name}.at", action)
    for name in study.hard_cases.every_method.cases:
        known = partial(check_name, name, list(study.hard_cases.all_cases), "hard case")
        yield from _attempt("hard_cases.every_method.cases", known)
