"""Sections on the figures: how all their runs ended, and each figure with its parameters."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from model.events.outcomes import Outcome, Reason
from model.physics.parameters import FIELDS, PARAMETER_NAMES
from model.show.report.section import (
    Results,
    Section,
    Table,
    assignments,
    link,
    subscripts,
    symbol,
    warned,
)
from model.show.schematics import CAPTIONS
from model.show.words import figure_number, figure_title, number, power

if TYPE_CHECKING:
    import xarray as xr

_LISTED = 8  # values of a varied parameter that are listed one by one


@dataclass(frozen=True)
class Counts:
    """Outcomes of the runs of a figure, and errors of their alignment times.

    Attributes:
        runs: how many there are.
        outcomes: how many ended with each outcome, by its name.
        chaotic: how many reached the horizon in chaotic motion.
        sensitive: how many depend sensitively on the tolerance.
        error_median: estimated error of the others.
        error_largest: likewise.
        error_largest_sensitive: largest estimated error of the sensitive runs.
    """

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


def counts_of(dataset: "xr.Dataset") -> Counts:
    """Count the outcomes of a figure's dataset and summarise its errors."""
    outcome = dataset["outcome"].values.ravel()
    sensitive = dataset["sensitive"].values.ravel() == 1
    error = dataset["tau_error"].values.ravel()
    found = np.bincount(outcome, minlength=len(Outcome))
    return Counts(
        runs=outcome.size,
        outcomes={each.name.lower(): int(found[each]) for each in Outcome},
        chaotic=int((dataset["reason"].values == Reason.CHAOTIC).sum()),
        sensitive=int(sensitive.sum()),
        error_median=_quantile(error[~sensitive], 0.5),
        error_largest=_quantile(error[~sensitive], 1.0),
        error_largest_sensitive=_quantile(error[sensitive], 1.0),
    )


def _quantile(values: NDArray[np.float64], share: float) -> float:
    known = values[~np.isnan(values)]
    return float(np.quantile(known, share)) if known.size else math.nan


def _dataset(results: Results, name: str) -> "xr.Dataset | None":
    if results.study.figures[name].kind == "schematic":
        return None
    return results.dataset(f"data/{name}.nc")


# --- All runs at a glance -----------------------------------------------------------------------

_OUTCOMES = {"aligned": "aligned", "settled": "settled", "left_scene": "left scene",
             "horizon_reached": "at horizon", "failed": "failed"}  # fmt: skip


def glance(results: Results) -> Section:
    """Return the section that counts the outcomes of every figure."""
    rows = []
    for name in results.study.figures:
        dataset = _dataset(results, name)
        if dataset is None:
            continue
        counts = counts_of(dataset)
        ended: list[object] = [counts.outcomes[outcome] for outcome in _OUTCOMES]
        ended[-1] = warned(ended[-1], serious=counts.outcomes["failed"] > 0)
        rows.append([link(figure_title(name), f"#{name}"), counts.runs, *ended, counts.sensitive,
                     power(counts.error_median)])  # fmt: skip
    heads = [f">{words}" for words in ("runs", *_OUTCOMES.values(), "sensitive")]
    table = Table(["figure", *heads, ">median error of τ"], rows)
    template = Path(__file__).with_name("figures.glance.html.j2")
    return Section("glance", "All runs at a glance", template, {"runs": table})


# --- The figures --------------------------------------------------------------------------------


def figures(results: Results) -> Section:
    """Return the section with every figure of the paper."""
    articles = [_article(results, name) for name in results.study.figures]
    entries = tuple(
        (figure_number(name), name, spec.title) for name, spec in results.study.figures.items()
    )
    template = Path(__file__).with_suffix(".html.j2")
    return Section("figures", "The figures", template, {"articles": articles}, entries)


def _article(results: Results, name: str) -> dict[str, object]:
    """Return what the template prints of one figure; ``counts`` is None for a drawing."""
    study = results.study
    spec, dataset = study.figures[name], _dataset(results, name)
    varied, counts, moment = Markup(""), None, None
    names: set[str] = set()
    if dataset is None:
        parameters = study.parameters(name)
        values = {each: _value(each, getattr(parameters, each)) for each in PARAMETER_NAMES}
    else:
        values = {each: _values(dataset, each) for each in PARAMETER_NAMES}
        names = {each for each in PARAMETER_NAMES if dataset[each].ndim}
        varied, counts = _varied(dataset), counts_of(dataset)
        if spec.kind == "history" and counts.outcomes["aligned"]:
            moment = float(dataset["tau_align"]), float(dataset["tau_error"])
    operating = {*study.operating_point, *spec.held} - names
    caption = spec.caption.strip()
    return {
        "name": name,
        "number": figure_number(name),
        "title": spec.title,
        "explained": subscripts(CAPTIONS.get(name, "")),
        "varied": varied,
        "held": assignments((each, values[each]) for each in values if each in operating),
        "parameters": _parameters(values, names),
        "counts": counts,
        "moment": moment,
        "picture": results.picture(
            f"figures/{name}", caption, f"Figure {figure_number(name)}: {spec.title}. {caption}"
        ),
        "files": (("dataset (netCDF)", f"data/{name}.nc"),) if dataset is not None else (),
    }


def _value(name: str, value: float | None) -> str:
    if value is None or math.isnan(value):
        return f"as {FIELDS[name].derived}"
    return number(value)


def _values(dataset: "xr.Dataset", name: str) -> str:
    values = dataset[name].values
    if values.ndim == 0:
        return _value(name, float(values))
    if values.size <= _LISTED:
        return ", ".join(number(value) for value in values)
    return f"{number(values[0])} to {number(values[-1])}, {values.size} values"


def _parameters(values: Mapping[str, str], varied: set[str]) -> Table:
    """List every parameter; the varied ones are in bold type."""
    bold, code = Markup("<strong>{}</strong>"), Markup("<code>{}</code>")
    rows = []
    for name, value in values.items():
        shown = bold.format(value) if name in varied else value
        rows.append((symbol(FIELDS[name].symbol), code.format(name), shown,
                     FIELDS[name].description))  # fmt: skip
    return Table(("symbol", "name", "value", "meaning"), rows)


def _varied(dataset: "xr.Dataset") -> Markup:
    """Describe the varied parameters, the one along the curves or the abscissa first."""
    parts = []
    for name in reversed([str(each) for each in dataset["tau_align"].dims]):
        relation = "from" if dataset[name].size > _LISTED else "="
        words = re.split(r"; | \(", FIELDS[name].description, maxsplit=1)[0]
        parts.append(
            Markup("{} {} {} {}").format(
                words, symbol(FIELDS[name].symbol), relation, _values(dataset, name)
            )
        )
    return Markup("; ").join(parts)
