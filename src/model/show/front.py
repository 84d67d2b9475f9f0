"""The front of the identification: claims shown against the regime, and the budget."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from model.show import style
from model.study.config import Aims
from model.study.identification.committed import BudgetFront, FrontSet

CAPTIONS: Mapping[str, str] = {
    "front": "The sets judged on the finer grids: claims shown, without those that ask what the "
    "other axes show, against the share of the aligned points that do not come to rest without "
    "vibration (left: mean over Figs. 5 to 14; right: in the worst figure), coloured by the median "
    "tilt at alignment in the worst figure. Ringed: no other set is better in claims, mean share "
    "and tilt. Star: the set with the least worst ratio to the aims (dashed; besides them those of "
    "tilt, corner conditions and the share that aligns), on the study's own grids. All sets of a "
    "front align over the stated share of every figure.",
    "budget": "The fronts that half and all of the searches by scores found, then half and all of "
    "the search by the aims, on the coarse grids: claims shown against the mean share of the "
    "aligned points that do not rest without vibration. Where the last two fronts lie apart, more "
    "search would find more.",
}


def front_picture(sets: Sequence[FrontSet], aims: Aims) -> Figure:
    """Draw the sets and the front; ``sets`` as in ``Identified.front``."""
    chosen = [each for each in sets if each.chosen]
    others = [each for each in sets if not each.chosen]
    total = sets[-1].claims + len(sets[-1].lacking - set(aims.beside))
    with style.context():
        figure = style.new_figure(height=9.0 * style.CENTIMETRE)
        left, right = np.asarray(figure.subplots(1, 2, sharey=True))
        mappable = ScalarMappable(Normalize(0.1, 0.4), style.DURATION_COLOURS)
        for axes, name, aim, words in (
            (left, "not_resting", aims.not_resting, "not at rest unvibrated, mean"),
            (right, "not_resting_most", aims.not_resting_most, "the same, worst figure"),
        ):
            axes.scatter(
                [getattr(each, name) for each in others],
                [each.claims for each in others],
                c=[each.tilt for each in others],
                s=14.0,
                cmap=mappable.cmap,
                norm=mappable.norm,
            )
            best = [each for each in others if each.best]
            axes.plot(
                [getattr(each, name) for each in best],
                [each.claims for each in best],
                "o",
                fillstyle="none",
                color=style.BLACK,
                markersize=6.0,
                markeredgewidth=0.7,
            )
            axes.plot(
                [getattr(each, name) for each in chosen],
                [each.claims for each in chosen],
                "*",
                color=style.VERMILLION,
                markersize=11.0,
            )
            axes.axvline(aim, color=style.GREY, linestyle="--")
            axes.axhline(total - aims.missing, color=style.GREY, linestyle="--")
            axes.set(xlabel=words, xlim=(0.0, None))
        left.set_ylabel("claims shown")
        figure.colorbar(mappable, ax=right, label="median tilt at alignment, worst figure, rad")
    return figure


def budget_picture(fronts: Sequence[BudgetFront], aims: Aims) -> Figure:
    """Draw the fronts of parts of the budget."""
    with style.context():
        figure = style.new_figure(height=8.0 * style.CENTIMETRE)
        axes = figure.subplots()
        for number, candidates in enumerate(sorted({each.candidates for each in fronts})):
            part = [each for each in fronts if each.candidates == candidates]
            part.sort(key=lambda each: each.not_resting)
            share = np.array([each.not_resting for each in part])
            most = np.maximum.accumulate([each.claims for each in part])
            drawn = style.curve(number, share.size)
            axes.step(share, most, where="post", label=f"{candidates} candidates", **drawn)
        axes.axvline(aims.not_resting, color=style.GREY, linestyle="--")
        axes.set(xlabel="not at rest unvibrated, mean over the figures", ylabel="claims shown")
        axes.legend(loc="lower right")
    return figure
