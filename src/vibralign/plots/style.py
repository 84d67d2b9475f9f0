"""Style, labels and cells of axes, and files: shared by all figures of the study.

Figures are made from ``matplotlib.figure.Figure``, never through pyplot, so that nothing is kept
in global state. Draw inside ``context()``; ``save`` enters it again, since fonts and SVG ids are
chosen only when a figure is written.
"""

import contextlib
import logging
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib import font_manager
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from model.events.outcomes import Outcome
from model.sweeps.files import atomic_write
from vibralign.plots.words import mathtext

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

FAILED_LABEL = "run failed"
NOT_ALIGNED = "does not align"
NOT_INSERTED = "aligns, but does not go in"

CENTIMETRE = 1.0 / 2.54  # in inches, the unit of figure sizes
FIGURE_WIDTH = 16.0 * CENTIMETRE  # the text width of an A4 page

# Okabe and Ito's colours, which stay apart for colour-blind readers. Their yellow is left out: it
# cannot be read on white.
BLACK, GREY = "#000000", "#6E6E6E"
BLUE, VERMILLION, GREEN = "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY_BLUE = "#CC79A7", "#E69F00", "#56B4E9"

# Colour and marker of each curve of a family, so that it survives a grey print. Lines are solid: a
# gap of one says that nothing aligns there, or that the duration jumps.
_CURVES: tuple[tuple[str, str], ...] = (
    (BLUE, "o"), (VERMILLION, "s"), (GREEN, "^"), (PURPLE, "D"), (ORANGE, "v"), (SKY_BLUE, "P"),
    (BLACK, "X"),
)  # fmt: skip
_BETWEEN_MARKERS = 0.12  # in diagonals of the axes

_RC: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],  # comes with matplotlib: the same on every machine
    "mathtext.fontset": "dejavusans",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": True,  # white behind the words, where curves pass
    "legend.framealpha": 0.85,
    "legend.edgecolor": "none",
    "legend.handlelength": 3.2,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "hatch.linewidth": 0.6,
    "image.cmap": "cividis",  # lightness rises steadily, for any colour vision and in grey
    "figure.figsize": (FIGURE_WIDTH, 10.0 * CENTIMETRE),
    "figure.constrained_layout.use": True,
    "figure.facecolor": "white",
    "savefig.dpi": 200.0,
    "savefig.bbox": "standard",  # a figure keeps the size it was given
    "svg.fonttype": "none",  # text stays text: it can be searched and copied
    "svg.hashsalt": "vibralign",  # else ids are random and the bytes change with every run
    "pdf.fonttype": 42,  # TrueType: text stays text
}

# Metadata that would make the bytes depend on the day or on the installed release.
_METADATA: Mapping[str, dict[str, None]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}
FORMATS: tuple[str, ...] = tuple(_METADATA)


@cache
def _prefer_own_fonts() -> None:
    """Put matplotlib's own fonts first: the machine's may differ, or lack the italics."""
    manager = font_manager.fontManager
    others = list(manager.ttflist)
    manager.ttflist.clear()
    for file in sorted(Path(mpl.get_data_path(), "fonts", "ttf").glob("*.ttf")):
        manager.addfont(file)
    manager.ttflist += others
    # fontTools warns of the date in matplotlib's own fonts, which no user can act on.
    logging.getLogger("fontTools.ttLib.tables._h_e_a_d").setLevel(logging.ERROR)


@contextlib.contextmanager
def context() -> Iterator[None]:
    """Draw inside with the study's settings over matplotlib's defaults, not over the user's."""
    _prefer_own_fonts()
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_RC)
        yield


def new_figure(width: float = FIGURE_WIDTH, height: float = 10.0 * CENTIMETRE) -> Figure:
    """Return an empty figure of ``width`` by ``height`` inches; call inside ``context``."""
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def curve(index: int) -> dict[str, Any]:
    """Return keyword arguments of ``Axes.plot`` for curve ``index`` of a family.

    Markers follow each other along the curve, shifted from curve to curve so that those of
    neighbours do not hide each other.
    """
    colour, marker = _CURVES[index % len(_CURVES)]
    along = (_BETWEEN_MARKERS * (0.1 + index % len(_CURVES) / len(_CURVES)), _BETWEEN_MARKERS)
    return {"color": colour, "marker": marker, "markevery": along}


# --- Axes ---------------------------------------------------------------------------------------


def symbol_of(coordinate: "xr.DataArray") -> str:
    """Return a parameter's symbol as mathematical text; its name where it has none."""
    symbol = coordinate.attrs.get("symbol", coordinate.name)
    return str(symbol) if symbol == coordinate.name else mathtext(symbol)


def axis_label(coordinate: "xr.DataArray") -> str:
    """Return the label of a parameter, such as "initial pressing force $f_{0}$"."""
    words = str(coordinate.attrs.get("long_name", coordinate.name))
    words = re.split(r"; | \(", words, maxsplit=1)[0]  # without the explanation
    symbol, unit = symbol_of(coordinate), coordinate.attrs.get("units", "1")
    label = words if symbol == words else f"{words} {symbol}"
    return label if unit == "1" else f"{label} in {unit.replace('radian', 'rad')}"


def label_of(name: str, unit: str) -> str:
    """Return the label of a quantity of a device file, such as "press_force (N)"."""
    return f"{name} ({unit.replace('radian', 'rad')})" if unit not in ("", "1") else name


def cell_edges(values: Floats) -> Floats:
    """Return the edges, shape (n + 1,), of the cells around ``values``, shape (n,) with n >= 2."""
    middles = 0.5 * (values[1:] + values[:-1])
    first, last = 1.5 * values[0] - 0.5 * values[1], 1.5 * values[-1] - 0.5 * values[-2]
    return np.concatenate([[first], middles, [last]])


def runs_of(mask: Bools) -> Iterator[tuple[int, int]]:
    """Yield stretches of True in ``mask``, shape (n,), as (first, one past the last)."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    yield from zip(steps[::2].tolist(), steps[1::2].tolist(), strict=True)


def flagged(dataset: "xr.Dataset", variable: str, meaning: str) -> Bools:
    """Return True where a variable has a flag whose meaning begins with ``meaning``."""
    flags = dataset[variable].attrs
    meanings = zip(flags["flag_meanings"].split(), flags["flag_values"], strict=True)
    wanted = [value for name, value in meanings if name.startswith(meaning)]
    return np.isin(dataset[variable].values, wanted)


def not_inserted(dataset: "xr.Dataset") -> Bools:
    """Return True where a part aligns and does not go in; False without ``insertion``."""
    aligned = np.asarray(dataset["outcome"].values == Outcome.ALIGNED)
    if "insertion" not in dataset:
        return np.zeros_like(aligned)
    return aligned & ~flagged(dataset, "insertion", "inserted")


# --- Files --------------------------------------------------------------------------------------


def save(figure: Figure, stem: Path) -> tuple[Path, ...]:
    """Write ``stem``.png, .svg and .pdf and return their paths; the same figure, the same bytes.

    Each file appears whole or not at all, so that an interrupted run leaves no half picture.
    """
    files = tuple(stem.with_name(f"{stem.name}.{kind}") for kind in FORMATS)
    for file in files:
        write(figure, file)
    return files


def write(figure: Figure, target: Path) -> None:
    """Write a figure in the format of the file's extension; the same figure, the same bytes."""
    kind = target.suffix.lower().lstrip(".")
    with atomic_write(target) as part, part.open("wb") as stream, context():
        figure.savefig(stream, format=kind, metadata=_METADATA.get(kind))
