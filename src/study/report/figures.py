"""Section on the figures: every figure with its result, and a table of all runs."""

from pathlib import Path

import numpy as np
import xarray as xr
from markupsafe import Markup

from model.events.outcomes import OUTCOME_TEXT, InsertionOutcome, Outcome, Reason
from model.physics.parameters import FIELDS
from study.claims.measures import share
from study.report.section import (
    Results,
    Section,
    Table,
    assignments,
    link,
    values_of,
)
from vibralign.plots.style import Bools, Floats
from vibralign.plots.words import figure_title, power, short

HEAD = "fig14"  # the figure at the head of the page, also in README
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

    @property
    def lost(self) -> int:
        """Number of the aligned runs whose part does not go in."""
        goes_in = self.dataset["insertion"].values == InsertionOutcome.INSERTED
        return int((self.aligned & ~goes_in).sum())

    @property
    def inserted_share(self) -> float:
        """Share of the aligned runs whose part goes in; NaN if none aligns."""
        return share(self.dataset["insertion"].values[self.aligned] == InsertionOutcome.INSERTED)


def counts_of(results: Results) -> dict[str, Counts]:
    """Return the counts of every computed figure."""
    return {name: Counts(results.dataset(f"data/{name}.nc")) for name in results.study.computed}


def section(results: Results) -> Section:
    """Return the section with every figure of the paper except the one at the head of the page."""
    outcomes = Table(
        ("outcome", "meaning"),
        [(_CODE.format(each.name.lower()), OUTCOME_TEXT[each]) for each in Outcome],
    )
    study = results.study
    rounds = [name for name, plane in study.maps.planes.items() if plane.shape == "round"]
    shown = [*study.figures, *rounds]
    counts = counts_of(results)
    content = {
        "articles": [article(results, name) for name in shown if name != HEAD],
        "entries": [(figure_title(name), name) for name in study.figures],
        "circles": any((own.sensitive & own.aligned).any() for own in counts.values()),
        "runs": _outcomes(counts),
        "durations": _durations(counts),
        "outcomes": outcomes,
    }
    return Section("figures", "The figures", Path(__file__).with_suffix(".html.j2"), content)


def _outcomes(counts: dict[str, Counts]) -> Table:
    """List the outcomes of the runs of every figure."""
    ends = [end for end in Outcome if any(own.number_of(end) for own in counts.values())]
    heads = [f">{end.name.lower().replace('_', ' ')}" for end in ends]
    return Table(
        ("figure", ">runs", *heads, ">chaotic", ">sensitive"),
        [
            (
                link(figure_title(name), f"#{name}"),
                f"{own.runs:,}",
                *(f"{own.number_of(end):,}" for end in ends),
                own.chaotic,
                int(own.sensitive.sum()),
            )
            for name, own in counts.items()
        ],
    )


def _durations(counts: dict[str, Counts]) -> Table:
    """List the durations of every figure, and their numerical errors."""
    return Table(
        ("figure", ">τ from", ">to", ">numerical error: median", ">largest", ">if sensitive"),
        [
            (
                link(figure_title(name), f"#{name}"),
                *((short(tau, 3) for tau in (own.tau.min(), own.tau.max()))
                  if own.tau.size else ("–", "–")),
                power(own.error(0.5)),
                power(own.error(1.0)),
                power(own.error(1.0, sensitive=True)),
            )
            for name, own in counts.items()
        ],
    )  # fmt: skip


def article(results: Results, name: str) -> dict[str, object]:
    """Return what the template prints of one figure."""
    study = results.study
    spec = study.spec_of(name)
    caption = spec.caption.strip()
    label = figure_title(name) if name in study.figures else "Further map"
    content: dict[str, object] = {
        "name": name,
        "label": label,
        "title": spec.title,
        "picture": results.picture(f"figures/{name}", caption, f"{label}: {spec.title}. {caption}"),
        "files": (),
        "held": "",
        "varied": "",
    }
    if name in study.named("schematic"):
        return content
    dataset = results.dataset(f"data/{name}.nc")
    varied = [str(each) for each in reversed(dataset["outcome"].dims)]
    held = ({*study.operating_point} | {*spec.held}) - {*varied}
    page = f"explorer.html#figure={name}"
    live = (("open this live", page),) if results.live and name in study.computed else ()
    return {
        **content,
        "files": (*live, ("dataset (netCDF)", f"data/{name}.nc")),
        "varied": assignments((each, values_of(dataset, each)) for each in varied),
        "held": assignments((each, values_of(dataset, each)) for each in FIELDS if each in held),
    }
