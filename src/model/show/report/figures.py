"""Section on the figures: every figure with its result, and a table of all runs."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from markupsafe import Markup

from model.events.outcomes import OUTCOME_TEXT, Outcome, Reason
from model.physics.parameters import FIELDS
from model.show.report.section import (
    Results,
    Section,
    Table,
    assignments,
    link,
    subscripts,
    symbol,
    values_of,
)
from model.show.schematics import CAPTIONS
from model.show.style import Bools, Floats, flagged, runs_of
from model.show.words import figure_number, figure_title, percent, power, short
from model.study.config.figures import COMPUTED, MAPS

HEAD = MAPS[-1]  # the figure at the head of the page, also in README
_FEW = 3  # most ranges that are stated one by one
_CODE = Markup("<code>{}</code>")


class Counts:
    """Outcomes of the runs of a figure; durations and their errors are dimensionless."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self.dataset = dataset
        self.runs = int(dataset["outcome"].size)
        # True for each run that aligns, and that ends differently at another tolerance.
        self.aligned: Bools = dataset["outcome"].values == Outcome.ALIGNED
        self.sensitive: Bools = dataset["sensitive"].values == 1
        self.aligned_share = float(self.aligned.mean())
        self.tau: Floats = dataset["tau_align"].values[self.aligned]  # of the runs that align, flat
        # Runs that depend sensitively on the start up to the horizon.
        self.chaotic = int((dataset["reason"].values == Reason.CHAOTIC).sum())

    def number_of(self, outcome: Outcome) -> int:
        """Return the number of runs with an outcome."""
        return int((self.dataset["outcome"].values == outcome).sum())

    def error(self, quantile: float, *, sensitive: bool = False) -> float:
        """Return a quantile of the estimated errors of the alignment times; NaN if there are none.

        ``quantile`` is from 0 to 1; only the runs count that are ``sensitive``, or are not.
        """
        error = self.dataset["tau_error"].values[self.sensitive == sensitive]
        error = error[~np.isnan(error)]
        return float(np.quantile(error, quantile)) if error.size else np.nan

    def share_of(self, variable: str, meaning: str) -> float:
        """Return the share of the aligned runs with a flag (``style.flagged``); NaN if unknown."""
        if variable not in self.dataset or not self.aligned.any():
            return np.nan
        return float(flagged(self.dataset, variable, meaning)[self.aligned].mean())


# Shares of the aligned runs: variable, beginning of its flag, words, head of the column.
SHARES = (
    ("insertion", "inserted", "of them go in", "go in"),
    ("unvibrated", "rests", "of them rest on the edge without vibration", "rest unvibrated"),
)


def counts_of(results: Results) -> dict[str, Counts]:
    """Return the counts of every computed figure."""
    return {name: Counts(results.dataset(f"data/{name}.nc")) for name in COMPUTED}


def section(results: Results) -> Section:
    """Return the section with every figure of the paper except the one at the head of the page."""
    outcomes = Table(
        ("outcome", "meaning"),
        [(_CODE.format(each.name.lower()), OUTCOME_TEXT[each]) for each in Outcome],
    )
    content = {
        "articles": [article(results, name) for name in results.study.figures if name != HEAD],
        "entries": [(figure_title(name), name) for name in results.study.figures],
        "runs": _glance(counts_of(results)),
        "outcomes": outcomes,
    }
    return Section("figures", "The figures", Path(__file__).with_suffix(".html.j2"), content)


def _glance(counts: dict[str, Counts]) -> Table:
    """List the outcomes of every figure, and the shares that some figure has."""
    shares = [row for row in SHARES if any(row[0] in own.dataset for own in counts.values())]
    ends = [end for end in Outcome if any(own.number_of(end) for own in counts.values())]
    heads = [f">{end.name.lower().replace('_', ' ')}" for end in ends]
    return Table(
        ("figure", ">runs", *heads, *(f">{head}" for *_, head in shares), ">sensitive",
         ">error of τ: median", ">largest"),
        [
            (
                link(figure_title(name), f"#{name}"),
                f"{own.runs:,}",
                *(f"{own.number_of(end):,}" for end in ends),
                *(percent(own.share_of(variable, flag)) for variable, flag, *_ in shares),
                int(own.sensitive.sum()),
                power(own.error(0.5)),
                power(own.error(1.0)),
            )
            for name, own in counts.items()
        ],
    )  # fmt: skip


def article(results: Results, name: str) -> dict[str, object]:
    """Return what the template prints of one figure."""
    study = results.study
    spec, caption = study.figures[name], study.figures[name].caption.strip()
    content: dict[str, object] = {
        "name": name,
        "number": figure_number(name),
        "title": spec.title,
        "explained": subscripts(CAPTIONS.get(name, "")),
        "picture": results.picture(
            f"figures/{name}", caption, f"Figure {figure_number(name)}: {spec.title}. {caption}"
        ),
        "files": (),
        "varied": "",
        "sentence": "",
    }
    if name not in COMPUTED:
        return content
    dataset = results.dataset(f"data/{name}.nc")
    varied = [str(each) for each in reversed(dataset["outcome"].dims)]
    held = ({*study.operating_point} | {*spec.held}) - {*varied}
    live = (("open this live", f"explorer.html#figure={name}"),) if results.live else ()
    return {
        **content,
        "files": (*live, ("dataset (netCDF)", f"data/{name}.nc")),
        "varied": assignments((each, values_of(dataset, each)) for each in varied),
        "held": assignments((each, values_of(dataset, each)) for each in FIELDS if each in held),
        "sentence": _moment(dataset) if spec.kind == "history" else _result(Counts(dataset)),
        "ranges": _ranges(dataset) if spec.kind == "curves" else "",
    }


def _moment(dataset: xr.Dataset) -> str:
    tau, error = float(dataset["tau_align"]), float(dataset["tau_error"])
    if np.isnan(tau):
        return f"It does not align: {OUTCOME_TEXT[Outcome(int(dataset['outcome']))]}."
    return f"It aligns at τ = {short(tau, 6)}, with an estimated error of {power(error)}."


def _result(counts: Counts) -> str:
    """Say in a sentence how the runs of a figure end."""
    words = f"{percent(counts.aligned_share)} of {counts.runs:,} runs align"
    if counts.tau.size:
        low, high = short(counts.tau.min(), 3), short(counts.tau.max(), 3)
        words += f", in τ = {low} to {high}"
    for variable, flag, text, _ in SHARES:
        share = counts.share_of(variable, flag)
        if not np.isnan(share):
            words += f"; {percent(share)} {text}"
    if counts.sensitive.any():
        error = power(counts.error(1.0, sensitive=True))
        words += f"; {int(counts.sensitive.sum())} are sensitive (error of τ up to {error})"
    if counts.chaotic:
        words += f"; {counts.chaotic} reach the horizon with sensitive dependence on the start"
    failed = counts.number_of(Outcome.FAILED)
    return words + (f"; {failed} failed." if failed else ".")


def _ranges(dataset: xr.Dataset) -> Markup:
    """Say over which values of the swept parameter each curve aligns."""
    family, swept = (dataset[str(name)] for name in dataset["outcome"].dims)
    own, along = (symbol(FIELDS[str(each.name)].symbol) for each in (family, swept))
    throughout, parts = [], []
    for value, aligned in zip(family.values, dataset["outcome"].values == 0, strict=True):
        if aligned.all():
            throughout.append(short(value, 3))
        else:
            x = swept.values
            ends = [(float(x[first]), float(x[end - 1])) for first, end in runs_of(aligned)]
            where = _in_words(along, ends)
            parts.append(Markup("at {} = {} {}").format(own, short(value, 3), where))
    if throughout:
        parts.insert(0, Markup("throughout at {} = {}").format(own, ", ".join(throughout)))
    return Markup("Aligns {}.").format(Markup("; ").join(parts))


def _in_words(along: Markup, ranges: Sequence[tuple[float, float]]) -> Markup:
    """Say in which ranges of a parameter, each by its first and last value, a curve aligns."""
    if not ranges:
        return Markup("nowhere")
    if len(ranges) > _FEW:
        low, high = short(ranges[0][0], 3), short(ranges[-1][1], 3)
        words = f"{len(ranges)} ranges between {low} and {high}"
        return Markup("for {} in {}").format(along, words)
    words = " and ".join(
        short(low, 3) if low == high else f"{short(low, 3)} to {short(high, 3)}"
        for low, high in ranges
    )
    return Markup("for {} = {}").format(along, words)
