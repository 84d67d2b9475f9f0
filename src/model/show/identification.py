"""The identification in pictures: how unique the device is, and which claims it shows."""

import itertools
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogFormatter
from numpy.typing import NDArray

from model.show import style
from model.show.axes import axis_label, symbol_of
from model.show.words import figure_title
from model.study.config import Range
from model.study.identification.band_table import Band

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
_LIGHT = 0.3
_BINS = 12
_NOT_REPRODUCED = "#F4D9C8"

# Symbol and meaning of the unknowns of the structure.
UNKNOWNS: Mapping[str, tuple[str, str]] = {
    "half_width": ("a", "half-width of the part"),
    "half_height": ("b", "half-height of the part"),
    "inertia_ratio": ("I/I₀", "moment of inertia over that of the bare part, (a² + b²)/3"),
    "lateral_stiffness": ("kₓ", "lateral stiffness of the suspension"),
    "lateral_damping_ratio": ("ζₓ", "damping ratio of the lateral motion"),
    "axial_damping_ratio": ("ζᵧ", "damping ratio along the axis"),
    "tilt_damping_ratio": ("ζᵩ", "damping ratio of the tilt at k_φ = 10"),
}
CAPTIONS: Mapping[str, str] = {
    "structure": "The admissible sets: every two unknowns of the structure, on axes as wide as the "
    "priors' ranges; the star and the lines are the study's device.",
    "claims": "The share of the admissible sets that reproduces each claim, and the share of draws "
    "from the prior that does: a claim that the prior reproduces as often says nothing about the "
    "device.",
    "bands": "Figs. 6 to 12 with the bands of the admissible sets: 5 % to 95 % of their durations "
    "where at least half of them align, dashed the median. Every set has an operating point of its "
    "own. Lines: the study's device, one curve of each figure.",
    "readings": "The claims that the best set under each variant of the equations reproduces; all "
    "variants were searched with the same budget. In brackets the number of those that count.",
}
READING_LABELS: Mapping[str, str] = {
    "consistent": "consistent",
    "printed": "as printed",
    "normal_sign": "R1 corrected: sign of U1",
    "friction_law": "R2 corrected: friction",
    "contact_damping_law": "R3 corrected: base damping",
    "side_gap": "R4 corrected: gap at A2",
    "side_force": "R5 corrected: force at A2",
    "preload": "R6 corrected: preload",
    "alignment_criterion": "R8 corrected: criterion",
    "moment_arms": "R9 corrected: arms",
}


def structure_pairs(
    ensemble: Mapping[str, Array], chosen: Mapping[str, float], ranges: Mapping[str, Range]
) -> Figure:
    """Draw every two unknowns of the structure over the ensemble; axes are the priors' ranges.

    Args:
        ensemble: values by unknown, each of shape (sets,).
        chosen: the study's own values.
        ranges: the priors.
    """
    names, size = list(ranges), len(ranges)
    with style.context():
        figure = style.new_figure(height=style.FIGURE_WIDTH)
        grid = np.asarray(figure.subplots(size, size))
        for row, column in itertools.product(range(size), range(size)):
            axes, x, y = grid[row, column], names[column], names[row]
            if column > row:
                axes.set_axis_off()
                continue
            _prior_axis(axes, "x", ranges[x])
            if column == row:
                edges = np.geomspace(ranges[x].low, ranges[x].high, _BINS + 1)
                axes.hist(ensemble[x], edges, color=style.SKY_BLUE)
                axes.axvline(chosen[x], color=style.VERMILLION)
                axes.set_yticks([])
            else:
                _prior_axis(axes, "y", ranges[y])
                axes.plot(
                    ensemble[x], ensemble[y], ".", color=style.BLUE, markersize=2.0, alpha=0.5
                )
                axes.plot(chosen[x], chosen[y], "*", color=style.VERMILLION, markersize=7.0)
            if row == size - 1:
                axes.set_xlabel(UNKNOWNS[x][0])
            else:
                axes.tick_params(axis="x", labelbottom=False)
            if column == 0 and row > 0:
                axes.set_ylabel(UNKNOWNS[y][0])
            elif column > 0:
                axes.tick_params(axis="y", labelleft=False)
    return figure


def _prior_axis(axes: Axes, which: str, law: Range) -> None:
    axes.set(**{f"{which}scale": "log", f"{which}lim": (law.low, law.high)})
    axis = axes.xaxis if which == "x" else axes.yaxis
    ticks = [law.low, float(np.sqrt(law.low * law.high)), law.high]
    axis.set_ticks(ticks, [f"{tick:.2g}" for tick in ticks], fontsize=6.0)
    axis.set_ticks([], minor=True)
    if which == "x":
        axes.tick_params(axis="x", labelrotation=60.0)


def band_curves(bands: Mapping[str, tuple[Band, ...]], datasets: Sequence["xr.Dataset"]) -> Figure:
    """Draw the ensemble's band behind one curve of each figure, the middle one of its family.

    Args:
        bands: by figure.
        datasets: the study's, of the same figures.
    """
    rows = (len(datasets) + 2) // 2
    with style.context():
        figure = style.new_figure(height=rows * 5.2 * style.CENTIMETRE)
        panels = np.asarray(figure.subplots(rows, 2)).ravel()
        for axes, dataset in zip(panels, datasets, strict=False):
            _draw_band(axes, bands[dataset.attrs["figure"]], dataset)
        for axes in panels[len(datasets) :]:
            axes.set_axis_off()
        panels[len(datasets)].legend(
            handles=[
                Line2D([], [], color=style.BLUE, label="the study's device"),
                Line2D([], [], color=style.VERMILLION, linestyle="--", label="median of the sets"),
                Patch(color=style.ORANGE, alpha=_LIGHT, label="9 of 10 of the sets that align"),
                Patch(color=style.GREY, alpha=_LIGHT, label="fewer than half of the sets align"),
            ],
            loc="center",
        )
    return figure


def _draw_band(axes: Axes, bands: Sequence[Band], dataset: "xr.Dataset") -> None:
    family, swept = (dataset[name] for name in dataset["tau_align"].dims)
    band = bands[len(bands) // 2]
    row = int(np.flatnonzero(family.values == band.at)[0])
    # Fig. 10's axis: each set over the bare inertia of its own part, from which the axis begins.
    x = band.x * (swept.values[0] if swept.name == "inertia" else 1.0)
    axes.fill_between(x, band.low, band.high, color=style.ORANGE, alpha=_LIGHT, linewidth=0.0)
    axes.plot(x, band.middle, color=style.VERMILLION, linestyle="--")
    axes.plot(swept.values, dataset["tau_align"].values[row], color=style.BLUE)
    few = ~np.isfinite(band.middle)
    axes.fill_between(
        x, 0.0, 1.0, where=few, transform=axes.get_xaxis_transform(), color=style.GREY,
        alpha=_LIGHT, linewidth=0.0, step="mid",
    )  # fmt: skip
    if np.isfinite(band.middle).any() or np.isfinite(dataset["tau_align"].values[row]).any():
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(LogFormatter())
        axes.yaxis.set_minor_formatter(LogFormatter())
    axes.set(xlim=(swept.values[0], swept.values[-1]), xlabel=axis_label(swept))
    title = figure_title(dataset.attrs["figure"])
    axes.set_title(f"{title}, {symbol_of(family)} = {band.at:g}", loc="left", pad=3.0)
    axes.set_ylabel("$τ$")


def claim_shares(
    claims: Sequence[str], ensemble: Array, prior: Array, reproduced: NDArray[np.bool_]
) -> Figure:
    """Draw for each claim the shares of the ensemble and of the prior that reproduce it.

    Args:
        claims: their names.
        ensemble: shares, shape (claims,).
        prior: shares, shape (claims,), NaN where unknown.
        reproduced: whether the best set found does, shape (claims,).
    """
    half = (len(claims) + 1) // 2
    with style.context():
        figure = style.new_figure(height=0.95 * style.FIGURE_WIDTH)
        for column, axes in enumerate(np.asarray(figure.subplots(1, 2))):
            part = slice(half * column, half * (column + 1))
            names, share, shown = claims[part], ensemble[part], reproduced[part]
            rows = np.arange(len(names))
            axes.plot(prior[part], rows, "o", color=style.GREY, fillstyle="none")
            axes.plot(share[shown], rows[shown], "o", color=style.BLUE)
            axes.plot(share[~shown], rows[~shown], "X", color=style.VERMILLION)
            axes.set_yticks(rows, names, fontsize=7.0)
            axes.set_ylim(half - 0.5, -0.5)
            axes.set_xlim(-0.04, 1.04)
            axes.set_xlabel("share that reproduces the claim")
        figure.legend(
            handles=[
                _dot("o", style.BLUE, "admissible sets; the best set reproduces it"),
                _dot("X", style.VERMILLION, "admissible sets; the best set does not"),
                _dot("o", style.GREY, "draws from the prior", hollow=True),
            ],
            loc="outside lower center",
            ncols=2,
        )
    return figure


def _dot(marker: str, colour: str, label: str, hollow: bool = False) -> Line2D:
    return Line2D(
        [], [], marker=marker, color=colour, linestyle="", label=label,
        fillstyle="none" if hollow else "full",
    )  # fmt: skip


def readings_by_claims(
    readings: Sequence[str], claims: Sequence[str], margins: Array, counted: NDArray[np.bool_]
) -> Figure:
    """Draw the claims that the best set found under each variant of the equations reproduces.

    Args:
        readings: names of the variants.
        claims: their names.
        margins: shape (readings, claims).
        counted: claims of which the number is stated, shape (claims,).
    """
    shown = np.asarray(margins > 0.0)
    with style.context():
        figure = style.new_figure(height=8.0 * style.CENTIMETRE)
        axes = figure.subplots()
        colours = np.where(shown[..., None], to_rgb(style.BLUE), to_rgb(_NOT_REPRODUCED))
        axes.imshow(colours, aspect="auto", interpolation="none")
        for row, column in zip(*np.nonzero(~shown), strict=True):
            axes.plot(column, row, "x", color=style.VERMILLION, markersize=3.0)
        axes.set_xticks(np.arange(len(claims)), claims, rotation=90.0, fontsize=5.5)
        names = [
            f"{READING_LABELS.get(each, each)} ({(row & counted).sum()})"
            for each, row in zip(readings, shown, strict=True)
        ]
        axes.set_yticks(np.arange(len(readings)), names, fontsize=7.0)
        axes.set_xticks(np.arange(len(claims)) - 0.5, minor=True)
        axes.set_yticks(np.arange(len(readings)) - 0.5, minor=True)
        axes.grid(visible=False)
        axes.grid(visible=True, which="minor", color="white", linewidth=0.6)
        axes.tick_params(which="minor", length=0)
        figure.legend(
            handles=[
                Patch(color=style.BLUE, label="reproduced"),
                Patch(color=_NOT_REPRODUCED, label="not reproduced"),
            ],
            loc="outside lower center",
            ncols=2,
        )
    return figure
