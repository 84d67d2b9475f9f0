"""Rules that need the whole study, such as those of parameters whose values are in two sections."""

import itertools
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from model.physics.parameters import FIELDS, REQUIRED_NAMES, check_name
from study.config.figures import FigureSpec, Jamming, Plane
from study.config.study import Study

_DRAWINGS = Path(__file__).resolve().parents[1] / "schematics"


def faults_of(study: Study) -> list[str]:
    """Return a line for every fault that only the whole study shows: path, value and rule."""
    faults = [*_values(study)]
    if not faults:
        for check in (_ranges, _sweeps, _searched, _cases, _others):
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


def _sweeps(study: Study, faults: list[str]) -> None:
    """Check figures, maps and jamming: what each varies and holds, at all corners of its grid."""
    specs: dict[str, FigureSpec | Plane | Jamming] = {"jamming": study.jamming}
    specs |= {f"figures.{name}": spec for name, spec in study.figures.items()}
    specs |= {f"maps.planes.{name}": plane for name, plane in study.maps.planes.items()}
    for place, spec in specs.items():
        names = [part.parameter for part in spec.varied]
        if len(set(names)) < len(names):
            faults.append(f"{place}: {names[0]!r} is varied twice")
        both = sorted({*names} & {*spec.held})
        faults += [f"{place}.held.{each}: is varied in the same figure" for each in both]
        ends = [(min(part.values), max(part.values)) for part in spec.varied]
        with _noted(place, faults):
            for corner in itertools.product(*ends):
                study.baseline.replace(**{**spec.held, **dict(zip(names, corner, strict=True))})
    for name in study.named("schematic"):
        if not (_DRAWINGS / f"{name}.py").is_file():
            drawing = f"study/schematics/{name}.py"
            faults.append(f"figures.{name}.kind = 'schematic': needs its drawing, {drawing}")


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
