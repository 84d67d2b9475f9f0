"""Hard cases: the stability table as a picture."""

import math
import re
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from benchmarks.hard_cases import Judged, Mark
from benchmarks.methods import METHODS
from benchmarks.problems import Verdict
from model.show import style

CAPTIONS: Mapping[str, str] = {
    "stability": "Result of each method on each hard case. A number is the power of ten of the "
    "error; W a wrong outcome, N more evaluations than it may, F a failure; a dot a right outcome "
    "without an error to measure. On the cases with a cell for every method each may make "
    "{shared:,} evaluations; on the others {others:,}, and scipy's methods are not run.",
}
# Light to dark, so that the marks stay apart in grey and for any colour vision.
_FILLS: Mapping[Mark, str] = {
    Mark.STABLE: "#D6E8F5",
    Mark.INACCURATE: style.ORANGE,
    Mark.OVER_BUDGET: "#B5B5B5",
    Mark.BROKEN: "#4A4A4A",
}
_LETTERS: Mapping[Verdict, str] = {
    Verdict.WRONG_OUTCOME: "W",
    Verdict.FAILED: "F",
    Verdict.TOO_MANY_EVALUATIONS: "N",
}


def cell_text(judged: Judged) -> str:
    """Return the text of a cell of the picture."""
    if judged.verdict != Verdict.RIGHT_OUTCOME:
        return _LETTERS[judged.verdict]
    if math.isnan(judged.error):
        return "·"
    # No error is below the rounding of numbers of order one.
    return f"{math.floor(math.log10(max(judged.error, 1e-16)))}".replace("-", "−")


def _set_symbols(title: str) -> str:
    """Return a title with its symbols as mathematical text: k_a gets a subscript."""
    return re.sub(r"\b(\w)_(\w)\b", r"$\1_\2$", title)


def stability(judged: Sequence[Judged], titles: Mapping[str, str]) -> Figure:
    """Draw a row for each case, a column for each method, coloured by its mark."""
    cases, methods = list(titles), list(METHODS)
    with style.context():
        figure = style.new_figure(height=(4.5 + 0.5 * len(cases)) * style.CENTIMETRE)
        axes = figure.subplots()
        for each in judged:
            if each.method not in METHODS:  # a way to do what one of them does
                continue
            x, y = methods.index(each.method), cases.index(each.case)
            axes.add_patch(
                Rectangle((x, y), 1.0, 1.0, facecolor=_FILLS[each.mark], edgecolor="white")
            )
            axes.text(
                x + 0.5, y + 0.5, cell_text(each), ha="center", va="center", fontsize=7.5,
                color="#FFFFFF" if each.mark is Mark.BROKEN else style.BLACK,
            )  # fmt: skip
        axes.set_xlim(0.0, len(methods))
        axes.set_ylim(len(cases), 0.0)
        labels = [METHODS[method].name.replace(", ", ",\n") for method in methods]
        axes.set_xticks([i + 0.5 for i in range(len(methods))], labels, fontsize=7.0, rotation=60)
        axes.set_yticks(
            [i + 0.5 for i in range(len(cases))],
            [_set_symbols(title) for title in titles.values()],
            fontsize=7.5,
        )
        axes.tick_params(length=0.0, labeltop=True, labelbottom=False)
        for label in axes.get_xticklabels():
            label.set(rotation_mode="anchor", ha="left", va="center")
        axes.grid(visible=False)
        for spine in axes.spines.values():
            spine.set_visible(False)
        figure.legend(
            handles=[Patch(facecolor=fill, label=mark.value) for mark, fill in _FILLS.items()],
            loc="outside lower center",
            ncols=4,
        )
        return figure
