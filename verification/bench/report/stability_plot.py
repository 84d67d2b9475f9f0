"""The table of methods and cases as a picture."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from verification.bench.methods import METHODS
from verification.bench.problems import Verdict
from verification.bench.report.advice import COARSE, ladders, nearest, needs
from verification.bench.work_precision import Setting
from vibralign.plots import style
from vibralign.plots.words import power

KEPT, INACCURATE = f"keeps {power(COARSE)}: evaluations", "does not: smallest error"
OUTCOME = "·: right outcome, no error known"
# Light to dark, so that the cells stay apart in grey and for any colour vision.
FILLS: Mapping[str, str] = {
    KEPT: "#D6E8F5",
    INACCURATE: style.ORANGE,
    OUTCOME: "#EEEEEE",
    "W: wrong outcome": style.VERMILLION,
    "N: over its limit": "#B5B5B5",
    "F: fails": "#4A4A4A",
}
_WORDS: Mapping[Verdict, str] = {
    Verdict.RIGHT_OUTCOME: INACCURATE,
    **dict(zip(list(Verdict)[1:], ("W: wrong outcome", "F: fails", "N: over its limit"),
               strict=True)),
}  # fmt: skip


def cell(ladder: Sequence[Setting], needed: Setting | None) -> tuple[str, str]:
    """Return the text of a cell and the key of its colour."""
    if needed is not None:
        return _short(needed.rhs_evaluations), KEPT
    best = nearest(ladder)
    words = _WORDS[best.verdict]
    if words is not INACCURATE:
        return words[0], words
    if math.isnan(best.error):
        return OUTCOME[0], OUTCOME
    return power(best.error).replace(" × ", "·"), words


def _short(count: int) -> str:
    """Return a number with two or three digits, such as 999, 1.3k, 85k or 14M."""
    for factor, unit in ((1e6, "M"), (1e3, "k")):
        if count >= factor:
            return f"{count / factor:.{1 if count < 9.95 * factor else 0}f}{unit}"
    return str(count)


def _set_symbols(title: str) -> str:
    """Return a title with its symbols as mathematical text: k_a gets a subscript."""
    return re.sub(r"\b(\w)_(\w)\b", r"$\1_\2$", title)


def stability(settings: Sequence[Setting], titles: Mapping[str, str]) -> Figure:
    """Draw a row for each case, a column for each method: what it takes to keep ``COARSE``."""
    cases, methods, needed = list(titles), list(METHODS), needs(settings, COARSE)
    with style.context():
        figure = style.new_figure(height=(4.5 + 0.5 * len(cases)) * style.CENTIMETRE)
        axes = figure.subplots()
        for (method, case), ladder in ladders(settings).items():
            text, words = cell(ladder, needed.get((method, case)))
            x, y = methods.index(method), cases.index(case)
            fill = FILLS[words]
            axes.add_patch(Rectangle((x, y), 1.0, 1.0, facecolor=fill, edgecolor="white"))
            colour = "#FFFFFF" if words.startswith("F") else style.BLACK
            look: Mapping[str, Any] = {"ha": "center", "va": "center", "color": colour}
            axes.text(x + 0.5, y + 0.5, text, fontsize=7.0, **look)
        axes.set_xlim(0.0, len(methods))
        axes.set_ylim(len(cases), 0.0)
        labels = [METHODS[method].name.replace(", ", ",\n") for method in methods]
        axes.set_xticks([i + 0.5 for i in range(len(methods))], labels, fontsize=7.0, rotation=60)
        named = [_set_symbols(title) for title in titles.values()]
        axes.set_yticks([i + 0.5 for i in range(len(cases))], named, fontsize=7.5)
        axes.tick_params(length=0.0, labeltop=True, labelbottom=False)
        for label in axes.get_xticklabels():
            label.set(rotation_mode="anchor", ha="left", va="center")
        axes.grid(visible=False)
        for spine in axes.spines.values():
            spine.set_visible(False)
        handles = [Patch(facecolor=fill, label=words) for words, fill in FILLS.items()]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        return figure
