"""The report: one page with every figure, what it shows, and what it was computed with.

The page holds its pictures, asks for nothing from outside, and is the same text for the same
inputs. Its wording and layout are in ``report.html.j2``; this module prepares what it prints.
"""

import base64
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape
from numpy.typing import NDArray

from model.events.outcomes import OUTCOME_TEXT, Outcome, Reason
from model.physics.parameters import FIELDS, PARAMETER_NAMES
from model.physics.readings import READING_NAMES
from model.show.claims import Ledger, claims_section
from model.show.contact_stiffness import Bases, contact_section
from model.show.hard_cases import CAPTIONS as HARD_CAPTIONS
from model.show.hard_cases import Hardness
from model.show.identification import (
    CAPTIONS as IDENTIFIED_CAPTIONS,
)
from model.show.identification import Pictured, Section, identification_section
from model.show.precision import (
    CAPTIONS as SPEED_CAPTIONS,
)
from model.show.precision import (
    COARSE,
    FINE,
    Comparison,
    Need,
    advice,
    needs,
)
from model.show.schematics import CAPTIONS
from model.show.style import FORMATS
from model.study.config import HardCases, Study
from model.study.fixed_steps import wrong_counts
from model.study.hard_cases import BATCH, DEFAULT, Judged, Mark
from model.study.identification.candidate import searched_of
from model.study.identification.committed import PICTURES as IDENTIFIED_PICTURES
from model.study.precision import METHODS
from model.study.precision_plans import HARD_PICTURES, PICTURES

if TYPE_CHECKING:
    import xarray as xr

_MEDIA_TYPES = {".png": "image/png", ".svg": "image/svg+xml"}

# R number and subject of every switch; model.physics.readings says what each value does.
READING_WORDS: Mapping[str, tuple[str, str]] = {
    "normal_sign": ("R1", "sign of the horizontal component of the contact force"),
    "friction_law": ("R2", "Coulomb friction with sticking, or one fixed direction"),
    "contact_damping_law": ("R3", "damping by the closing rate, or by the speed of the part"),
    "side_gap": ("R4", "distance of the edge A2 from the side face"),
    "side_force": ("R5", "direction of the force on the side face"),
    "preload": ("R6", "whether the axial spring is relaxed at the start, or at y = 0"),
    "alignment_criterion": ("R8", "loss of the contact over the slot, or the four corners inside"),
    "moment_arms": ("R9", "arms of the deformed or of the undeformed contact"),
}


@dataclass(frozen=True)
class _Row:
    """One line of a table of parameters."""

    symbol: Markup
    name: str
    value: str
    meaning: str
    varied: bool


@dataclass(frozen=True)
class _Counts:
    """How the runs of a figure ended, and how well their alignment times are known."""

    runs: int
    outcomes: Mapping[str, int]
    chaotic: int
    sensitive: int
    error_median: float
    error_largest: float
    error_largest_sensitive: float

    @property
    def aligned_share(self) -> float:
        """Share of the runs that align."""
        return self.outcomes["aligned"] / self.runs


@dataclass(frozen=True)
class _Section:
    """What the page says of one figure."""

    name: str
    number: int
    kind: str
    title: str
    sees: str
    explained: Markup
    varied: Markup
    held: Markup
    rows: tuple[_Row, ...]
    counts: _Counts | None
    moment: tuple[float, float] | None
    picture: Markup
    size: tuple[int, int] | None
    alternative: str


@dataclass(frozen=True)
class _Picture:
    """A picture of the section on speed against error."""

    place: str
    caption: str
    data: Markup
    size: tuple[int, int] | None


@dataclass(frozen=True)
class _Speed:
    """What the page says of speed against error.

    ``tables`` holds, for each true error, a row for each method with a cell for each case.
    """

    sentences: tuple[str, ...]
    pictures: tuple[_Picture, ...]
    cases: tuple[tuple[str, str, str, Markup], ...]
    tables: tuple[tuple[float, tuple[tuple[str, tuple[Need | None, ...]], ...]], ...]
    wrong: tuple[tuple[str, str, float, Mapping[str, int]], ...]


@dataclass(frozen=True)
class _HardRow:
    """One case and what every method makes of it."""

    title: Markup
    values: Markup
    until: float
    judged: tuple[Judged, ...]


@dataclass(frozen=True)
class _Gain:
    """A base on which the default method and the batch engine are compared."""

    title: Markup
    default: Judged
    batch: Judged


@dataclass(frozen=True)
class _Hard:
    """What the page says of hard cases."""

    spec: HardCases
    sentences: tuple[str, ...]
    pictures: tuple[_Picture, ...]
    rows: tuple[_HardRow, ...]
    gains: tuple[_Gain, ...]
    longer: tuple[str, ...]
    labels: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What the study found and the page shows.

    Attributes:
        datasets: of every figure that computes something, by its name ("fig06").
        figures: a picture of every figure, PNG or SVG, by its name.
        comparison: what was measured of speed against error.
        ledger: what was found of the claims of the paper.
        bases: figures on bases of other stiffness and damping.
        hardness: what every method makes of the hard cases.
        identified: what the identification found, where its result is committed.
    """

    datasets: Mapping[str, "xr.Dataset"]
    figures: Mapping[str, Path]
    comparison: Comparison
    ledger: Ledger
    bases: Bases
    hardness: Hardness
    identified: Pictured | None = None

    def check(self, study: Study) -> None:
        """Raise ValueError naming what ``study`` has and this lacks."""
        computed = [name for name, spec in study.figures.items() if spec.kind != "schematic"]
        missing = [f"the dataset of {name}" for name in computed if name not in self.datasets]
        pictures = [(study.figures, self.figures), (PICTURES, self.comparison.pictures)]
        pictures += [(HARD_PICTURES, self.hardness.pictures)]
        for needed, there in pictures:
            missing += [f"the picture of {name}" for name in needed if name not in there]
        if missing:
            raise ValueError(f"the report needs {', '.join(missing)}")


def render_report(study: Study, findings: Findings, provenance: Mapping[str, object]) -> str:
    """The page.

    Links to datasets (``data/fig06.nc``) and figures (``figures/fig06.svg``) are relative to the
    results root, where the page belongs. Of ``provenance``, what is said of the making of the page,
    a value may be a mapping itself.

    Raises:
        ValueError: a dataset or a picture is missing, or a picture is neither PNG nor SVG.
    """
    findings.check(study)
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(number=number, power=_power, subscripts=_with_subscripts)
    sections = [
        _section(study, name, findings.datasets.get(name), findings.figures[name])
        for name in study.figures
    ]
    settings = study.settings.settings
    return environment.get_template("report.html.j2").render(
        sections=sections,
        speed=_speed(study, findings.comparison),
        claims=claims_section(
            findings.ledger.lines, {name: run.title for name, run in study.claims_runs.items()}
        ),
        claims_picture=_embedded(findings.ledger.picture),
        contact=contact_section(findings.bases.datasets),
        contact_picture=_embedded(findings.bases.picture),
        identified=_identified(study, findings.identified),
        identified_pictures=_identified_pictures(findings.identified),
        hard=_hard(study.hard_cases, findings.hardness),
        tau_tolerance=study.precision.fixed_steps.tau_tolerance,
        structure=[_row(name, number(value)) for name, value in study.structure.items()],
        readings=[
            (*READING_WORDS[name], name, getattr(settings.readings, name)) for name in READING_NAMES
        ],
        outcomes=[(outcome.name.lower(), OUTCOME_TEXT[outcome]) for outcome in Outcome],
        settings=settings,
        provenance=[
            (key, list(value.items()) if isinstance(value, Mapping) else [("", value)])
            for key, value in provenance.items()
        ],
        formats=FORMATS,
    )


# --- What is said of one figure -----------------------------------------------------------------


def _section(study: Study, name: str, dataset: "xr.Dataset | None", picture: Path) -> _Section:
    spec = study.figures[name]
    if dataset is None:
        parameters = study.parameters(name)
        values = {each: getattr(parameters, each) for each in PARAMETER_NAMES}
        rows = tuple(_row(each, _value(each, value)) for each, value in values.items())
        varied, counts, moment = Markup(""), None, None
    else:
        rows = tuple(_dataset_row(dataset, each) for each in PARAMETER_NAMES)
        varied, counts = _varied(dataset), _counts(dataset)
        moment = None
        if spec.kind == "history" and counts.outcomes["aligned"]:
            moment = float(dataset["tau_align"]), float(dataset["tau_error"])
    operating = {*study.operating_point, *spec.held}
    held = Markup(", ").join(
        _equals(row) for row in rows if row.name in operating and not row.varied
    )
    number_of = int(name.removeprefix("fig"))
    data, size = _embedded(picture)
    return _Section(
        name=name,
        number=number_of,
        kind=spec.kind,
        title=spec.title,
        sees=spec.sees.strip(),
        explained=_with_subscripts(CAPTIONS.get(name, "")),
        varied=varied,
        held=held,
        rows=rows,
        counts=counts,
        moment=moment,
        picture=data,
        size=size,
        alternative=f"Figure {number_of}: {spec.title}. {spec.sees.strip()}",
    )


def _speed(study: Study, comparison: Comparison) -> _Speed:
    cases = study.precision.cases
    titles = {name: case.title for name, case in cases.items()}
    tables = []
    for target in (COARSE, FINE):
        need = needs(comparison.rungs, target)
        rows = [
            (method.label, tuple(need.get((name, case)) for case in cases))
            for name, method in METHODS.items()
        ]
        tables.append((target, tuple(rows)))
    pictures = []
    for name, place in PICTURES.items():
        data, size = _embedded(comparison.pictures[name])
        pictures.append(_Picture(place, SPEED_CAPTIONS[name], data, size))
    return _Speed(
        sentences=advice(comparison.rungs, comparison.wrong, titles),
        pictures=tuple(pictures),
        cases=tuple(
            (
                case.title,
                case.figure,
                case.reason,
                Markup(", ").join(
                    _equals(_row(name, number(value))) for name, value in case.at.items()
                ),
            )
            for case in cases.values()
        ),
        tables=tuple(tables),
        wrong=tuple(
            (figure.removeprefix("fig").lstrip("0"), _SCHEME_WORDS[scheme], step, counts)
            for figure, dataset in comparison.wrong.items()
            for (scheme, step), counts in wrong_counts(dataset).items()
        ),
    )


def _identified(study: Study, identified: Pictured | None) -> Section | None:
    if identified is None:
        return None
    ranges = study.identification.law.structure
    return identification_section(identified.found, searched_of(study.structure), ranges)


def _identified_pictures(identified: Pictured | None) -> list[_Picture]:
    if identified is None:
        return []
    return [
        _Picture(IDENTIFIED_PICTURES[name], IDENTIFIED_CAPTIONS[name], *_embedded(path))
        for name, path in identified.pictures.items()
    ]


def _hard(spec: HardCases, hardness: Hardness) -> _Hard:
    cases = spec.all_cases
    pictures = []
    for name, place in HARD_PICTURES.items():
        data, size = _embedded(hardness.pictures[name])
        pictures.append(_Picture(place, HARD_CAPTIONS[name], data, size))
    rows = tuple(
        _HardRow(
            title=_with_subscripts(case.title),
            values=Markup(", ").join(
                _equals(_row(each, number(value))) for each, value in case.at.items()
            ),
            until=case.until,
            judged=tuple(each for each in hardness.judged if each.case == name),
        )
        for name, case in cases.items()
    )
    found = {(each.case, each.method): each for each in hardness.judged}
    gains = tuple(
        _Gain(_with_subscripts(cases[case].title), found[case, DEFAULT], batch)
        for (case, method), batch in found.items()
        if method == BATCH
    )
    sentences = []
    for method, how in METHODS.items():
        marks = [each.mark for each in hardness.judged if each.method == method]
        counts = ", ".join(f"{marks.count(mark)} {mark.value}" for mark in Mark)
        sentences.append(f"{how.label}: {counts}.")
    return _Hard(
        spec=spec,
        sentences=tuple(sentences),
        pictures=tuple(pictures),
        rows=rows,
        gains=gains,
        longer=tuple(
            f"{case.title}, {case.max_evaluations:,}"
            for case in cases.values()
            if case.max_evaluations
        ),
        labels={name: how.label for name, how in METHODS.items()}
        | {BATCH: "batch engine (Taylor series), switches located"},
    )


_SCHEME_WORDS = {"rk4": "RK4", "semi_implicit_euler": "semi-implicit Euler"}


def _row(name: str, value: str, varied: bool = False) -> _Row:
    field = FIELDS[name]
    return _Row(symbol(field.symbol), name, value, field.description, varied)


def _value(name: str, value: float | None) -> str:
    if value is None or math.isnan(value):
        return f"as {FIELDS[name].derived}"
    return number(value)


def _dataset_row(dataset: "xr.Dataset", name: str) -> _Row:
    values = dataset[name].values
    if values.ndim == 0:
        return _row(name, _value(name, float(values)))
    if values.size <= 8:
        return _row(name, ", ".join(number(value) for value in values), varied=True)
    return _row(
        name, f"{number(values[0])} to {number(values[-1])}, {values.size} values", varied=True
    )


def _equals(row: _Row) -> Markup:
    return Markup("<span class=nobreak>{} = {}</span>").format(row.symbol, row.value)


def _varied(dataset: "xr.Dataset") -> Markup:
    """The varied parameters in words, the one along the curves or the abscissa first."""
    parts = []
    for name in reversed([str(each) for each in dataset["tau_align"].dims]):
        row = _dataset_row(dataset, name)
        link = "from" if dataset[name].size > 8 else "="
        words = re.split(r"; | \(", row.meaning, maxsplit=1)[0]  # what follows explains
        parts.append(Markup("{} {} {} {}").format(words, row.symbol, link, row.value))
    return Markup("; ").join(parts)


def _counts(dataset: "xr.Dataset") -> _Counts:
    outcome = dataset["outcome"].values.ravel()
    sensitive = dataset["sensitive"].values.ravel() == 1
    error = dataset["tau_error"].values.ravel()
    found = np.bincount(outcome, minlength=len(Outcome))
    return _Counts(
        runs=outcome.size,
        outcomes={each.name.lower(): int(found[each]) for each in Outcome},
        chaotic=int((dataset["reason"].values == Reason.CHAOTIC).sum()),
        sensitive=int(sensitive.sum()),
        error_median=_summary(error[~sensitive], 0.5),
        error_largest=_summary(error[~sensitive], 1.0),
        error_largest_sensitive=_summary(error[sensitive], 1.0),
    )


def _summary(values: NDArray[np.float64], share: float) -> float:
    known = values[~np.isnan(values)]
    return float(np.quantile(known, share)) if known.size else math.nan


# --- How it is written --------------------------------------------------------------------------


def symbol(text: str) -> Markup:
    """A symbol as it stands in FIELDS, as HTML: f0 and k_φ get a subscript."""
    head, rest = text[0], text[1:]
    if rest.startswith("_") or rest.isdigit():
        return Markup("<i>{}</i><sub>{}</sub>").format(head, rest.lstrip("_"))
    return Markup("<i>{}</i>").format(text)


def _with_subscripts(text: str) -> Markup:
    """Plain text as HTML in which K_X1 has a subscript."""
    return Markup(re.sub(r"\b(\w)_(\w+)", r"\1<sub>\2</sub>", str(escape(text))))  # noqa: S704


def number(value: float) -> str:
    """A number as short as it can be written."""
    return f"{value:.6g}"


def _power(value: float) -> Markup:
    """An error to one digit: 3 × 10⁻⁹."""
    if math.isnan(value):
        return Markup("–")
    mantissa, exponent = f"{value:.0e}".split("e")
    if value == 0.0 or -3 <= int(exponent) <= 3:
        return escape(f"{value:.1g}")
    power = str(int(exponent)).replace("-", "\N{MINUS SIGN}")
    return Markup("{} × 10<sup>{}</sup>").format(mantissa, power)


def _embedded(picture: Path) -> tuple[Markup, tuple[int, int] | None]:
    """The picture as a data address, and its width and height in pixels where it has any."""
    media_type = _MEDIA_TYPES.get(picture.suffix)
    if media_type is None:
        raise ValueError(f"{picture}: must be one of {', '.join(_MEDIA_TYPES)}")
    content = picture.read_bytes()
    size = None
    if picture.suffix == ".png":  # the header chunk of every PNG starts at byte 16 with its size
        size = int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
    data = base64.b64encode(content).decode("ascii")
    return Markup(f"data:{media_type};base64,{data}"), size  # noqa: S704  (base64 needs no escape)
