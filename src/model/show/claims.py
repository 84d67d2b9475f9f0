"""The claims ledger for readers: the report's section, and a picture of the ledger's own runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from model.show import style
from model.show.plots import axis_label, cell_edges, math
from model.study.claims import VERDICTS, tally
from model.study.claims.table import Line

if TYPE_CHECKING:
    import xarray as xr

# What of a run the ledger looks at, where that is not the duration.
_SHOWN: Mapping[str, tuple[str, str]] = {
    "centred": ("excursion", "largest way of $x$"),
    "pressed": ("tilt_end", "tilt at the end (rad)"),
    "displaced": ("way", "share of the way to the slot"),
}
_CROSS: Mapping[str, Any] = {
    "color": style.BLACK, "linestyle": "none", "marker": "x", "markersize": 3.5,
}  # fmt: skip
_DURATION = ("tau_align", "alignment duration $τ$")
RUNS_CAPTION = (
    "What only the ledger asks for. Where the duration is shown, a curve has a gap where the part "
    "does not align; where another quantity is shown, a cross marks runs that do."
)


@dataclass(frozen=True)
class Ledger:
    """What the report says of the paper's claims: the ledger's lines, and a picture of its runs."""

    lines: Sequence[Line]
    picture: Path


@dataclass(frozen=True)
class ClaimRow:
    """A claim as the page shows it; ``sources`` are (words, address)."""

    line: Line
    sign: str
    sources: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class ClaimsSection:
    """What the page says of the claims."""

    tally: str
    rows: tuple[ClaimRow, ...]
    caption: str
    runs: tuple[tuple[str, str], ...]


_SIGNS: Mapping[str, str] = dict(zip(VERDICTS, ("✓", "±", "✗", "–"), strict=True))


def claims_section(lines: Sequence[Line], titles: Mapping[str, str]) -> ClaimsSection:
    """The section on claims.

    Args:
        lines: the ledger.
        titles: of the ledger's own runs, by name.
    """
    return ClaimsSection(
        tally=tally([line.verdict for line in lines]),
        rows=tuple(
            ClaimRow(
                line, _SIGNS.get(line.verdict, "?"), tuple(_source(s, titles) for s in line.sources)
            )
            for line in lines
        ),
        caption=RUNS_CAPTION,
        runs=tuple(titles.items()),
    )


def _source(name: str, titles: Mapping[str, str]) -> tuple[str, str]:
    if name in titles:
        letter = ascii_lowercase[list(titles).index(name)]
        return f"run {letter}", "#claims-runs"
    return f"Fig. {int(name.removeprefix('fig'))}", f"#{name}"


# --- The picture --------------------------------------------------------------------------------


def draw_runs(datasets: Mapping[str, "xr.Dataset"]) -> Figure:
    """A panel for each of the ledger's own runs, in the order given."""
    rows = -(-len(datasets) // 2)
    with style.context():
        figure = style.new_figure(height=7.2 * rows * style.CENTIMETRE)
        panels = figure.subplots(rows, 2, squeeze=False)
        for place, (name, dataset) in enumerate(datasets.items()):
            axes = panels.flat[place]
            title = str(dataset.attrs["title"])
            axes.set_title(f"$\\bf{{{ascii_lowercase[place]}}}$  {title}", loc="left")
            _draw_run(axes, dataset, *_SHOWN.get(name, _DURATION))
        for axes in panels.flat[len(datasets) :]:
            axes.set_visible(False)
        return figure


def _draw_run(axes: Axes, dataset: "xr.Dataset", variable: str, label: str) -> None:
    family, swept = (dataset[str(name)] for name in dataset["tau_align"].dims)
    symbol = math(str(family.attrs.get("symbol", family.name)))
    for row, value in enumerate(family.values):
        values = dataset[variable].values[row]
        look = style.curve(row, values.size, markers=5)
        axes.plot(swept.values, values, label=f"{symbol} = {value:g}", **look)
        aligned = np.isfinite(dataset["tau_align"].values[row])
        if variable != _DURATION[0] and aligned.any():
            axes.plot(swept.values[aligned], values[aligned], **_CROSS)
    edges = cell_edges(swept.values)
    axes.set_xlim(edges[0], edges[-1])
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    axes.set_xlabel(axis_label(swept))
    axes.set_ylabel(label)
    axes.legend(loc="best")
