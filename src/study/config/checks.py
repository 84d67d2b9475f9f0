"""Rules that need the whole study, such as those of parameters whose values are in two sections."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from model.physics.parameters import FIELDS, REQUIRED_NAMES, Batch, Parameters, check_name
from model.sweeps.axes import Axis, Family, check_plane
from study.config.figures import Curves, Map
from study.config.study import Study

_DRAWINGS = Path(__file__).resolve().parents[1] / "schematics"


def faults_of(study: Study) -> list[str]:
    """Return a line for every fault that only the whole study shows: path, value and rule."""
    faults = [*_values(study)]
    if not faults:
        for check in (_ranges, _figures, _searched, _planes, _jamming, _cases, _others):
            check(study, faults)
    return faults


def _broken(place: str, values: Mapping[str, float]) -> Iterable[str]:
    """Yield a line for each value that breaks the rule of its parameter."""
    for name, value in values.items():
        if not FIELDS[name].admits(value):
            yield f"{place}.{name} = {value!r}: {FIELDS[name].rule}"


@contextmanager
def _noted(place: str, faults: list[str]) -> Iterator[None]:
    """Add a line with the refusal that the block raises, if it raises one, and go on."""
    try:
        yield
    except (TypeError, ValueError) as error:
        faults.append(f"{place}: {error}")


def _varied(
    place: str, what: str, parts: Iterable[Axis | Family], held: Iterable[str]
) -> Iterable[str]:
    """Yield a line for each parameter that is varied twice, or both held and varied."""
    names = [part.parameter for part in parts]
    if len(set(names)) < len(names):
        yield f"{place}: {names[0]!r} is varied twice"
    for each in sorted(set(names) & set(held)):
        yield f"{place}.held.{each}: is varied in the same {what}"


def _vary(parameters: Parameters, part: Axis | Family) -> None:
    Batch.of(parameters, **{part.parameter: part.values})


def _values(study: Study) -> Iterable[str]:
    yield from _broken("structure", study.structure)
    yield from _broken("operating_point", study.operating_point)
    for name in REQUIRED_NAMES:
        if name not in study.structure and name not in study.operating_point:
            yield f"structure.{name}: missing ({FIELDS[name].description})"
    for name, figure in study.figures.items():
        yield from _broken(f"figures.{name}.held", figure.held)


def _ranges(study: Study, faults: list[str]) -> None:
    """Check the ranges of the accuracy trial."""
    place, ranges = "accuracy.ranges", study.accuracy.ranges
    ends = [{name: law.low for name, law in ranges.items()}]
    ends.append({name: 0.0 for name, law in ranges.items() if law.zero > 0.0})
    broken = [fault for values in ends for fault in _broken(place, values)]
    faults += broken
    if not broken:
        # The worst combination of the ends: the farthest start on the narrowest part.
        narrow = {"half_width", "clearance"}
        worst = {name: law.low if name in narrow else law.high for name, law in ranges.items()}
        with _noted(place, faults):
            study.baseline.replace(**worst)


def _figures(study: Study, faults: list[str]) -> None:
    for name, figure in study.figures.items():
        place = f"figures.{name}"
        if figure.kind == "schematic" and not (_DRAWINGS / f"{name}.py").is_file():
            faults.append(
                f"{place}.kind = 'schematic': needs its drawing, study/schematics/{name}.py"
            )
        varied: dict[str, Axis | Family] = {}
        if isinstance(figure, Curves):
            varied = {"swept": figure.swept, "family": figure.family}
        elif isinstance(figure, Map):
            varied = {"x": figure.x, "y": figure.y}
        faults += _varied(place, "figure", varied.values(), figure.held)
        with _noted(f"{place}.held", faults):
            held = study.parameters(name)
            for key, part in varied.items():
                with _noted(f"{place}.{key}", faults):
                    _vary(held, part)


def _planes(study: Study, faults: list[str]) -> None:
    for name, plane in study.maps.planes.items():
        place = f"maps.planes.{name}"
        for axis in (plane.x, plane.y):
            faults += _varied(place, "map", (axis,), plane.held)
        with _noted(place, faults):
            held = study.baseline.replace(**plane.held)
            check_plane(lambda values: held.replace(**values), plane.x, plane.y)  # noqa: B023


def _jamming(study: Study, faults: list[str]) -> None:
    spec = study.jamming
    parts = (spec.clearance, spec.tilt_stiffness, spec.friction)
    faults += _varied("jamming", "figure", parts, spec.held)
    for part in parts:
        with _noted("jamming", faults):
            _vary(study.baseline.replace(**spec.held), part)


def _searched(study: Study, faults: list[str]) -> None:
    for name in study.identification.operating_points:
        with _noted("identification.operating_points", faults):
            check_name(name, study.computed, "figure")


def _cases(study: Study, faults: list[str]) -> None:
    for name, case in study.precision.cases.items():
        with _noted(f"precision.cases.{name}", faults):
            check_name(case.figure, study.computed, "figure")
            study.case(name)
    for name, hard in study.precision.hard.all_cases.items():
        with _noted(f"precision.hard.cases.{name}.at", faults):
            study.baseline.replace(**hard.at)
    hard_cases = study.precision.hard
    for name in hard_cases.independent:
        with _noted("precision.hard.independent", faults):
            check_name(name, list(hard_cases.all_cases), "hard case")


def _others(study: Study, faults: list[str]) -> None:
    """Check the devices of searches: each states all unknowns."""
    spec = study.identification
    points = spec.operating_points.items()
    unknowns = {*spec.structure} | {f"{figure}.{name}" for figure, of in points for name in of}
    for name, values in study.evidence.others.items():
        place = f"evidence.others.{name}"
        with _noted(place, faults):
            check_name(name, list(spec.searches), "search")
        for each in sorted(unknowns ^ values.keys()):
            missing = "missing" if each in unknowns else "no unknown of the searches"
            faults.append(f"{place}.{each}: {missing}")
