"""Picture of a device that is known in part: what trials leave possible, and their times."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from vibralign.answers.si import display
from vibralign.device import StatedDevice
from vibralign.device.stated import quantity_of
from vibralign.known.calibrate import Calibration
from vibralign.plots import style
from vibralign.plots.style import CENTIMETRE, Floats

_BINS = 16


def _scaled(name: str, values: Floats, device: StatedDevice) -> tuple[Floats, str]:
    """Return values in the unit of the file, or in which they are read, and the axis' label."""
    usual = display(float(np.abs(values).max()), quantity_of(name)[1])
    unit, one = device.written.get(name, usual)
    return values / one, style.label_of(name, unit)


def calibration(found: Calibration) -> Figure:
    """Draw the unknowns before and after, the most correlated pair, and the times of the trials."""
    names = list(found.device.unknown)
    with style.context():
        if not found.fit.fits:
            figure = style.new_figure(height=7.0 * CENTIMETRE)
            _times(times := figure.subplots(), found)
            times.set_title("the model does not fit these trials", loc="left")
            figure.legend(*times.get_legend_handles_labels(), loc="outside lower right", ncols=3)
            return figure
        figure = style.new_figure(height=11.0 * CENTIMETRE)
        grid = figure.add_gridspec(2, 2 * len(names))
        sets = found.equally(400)
        for i, name in enumerate(names):
            axes = figure.add_subplot(grid[0, 2 * i : 2 * i + 2])
            _marginal(axes, found, name, sets[name], first=not i)
        middle = len(names)
        _pair(figure.add_subplot(grid[1, :middle]), sets, found.device)
        times = figure.add_subplot(grid[1, middle:])
        _times(times, found)
        figure.legend(*times.get_legend_handles_labels(), loc="outside lower right", ncols=3)
    return figure


def _marginal(axes: Axes, found: Calibration, name: str, values: Floats, *, first: bool) -> None:
    ends = np.array(found.device.unknown[name])
    after, label = _scaled(name, np.concatenate([ends, values]), found.device)
    before = found.device.unknown[name].at(np.linspace(0.0, 1.0, 400)) * after[1] / ends[1]
    bins = np.linspace(after[0], after[1], _BINS + 1).tolist()
    axes.hist(before, bins, density=True, histtype="step", color=style.GREY, label="before")
    axes.hist(after[2:], bins, density=True, color=style.BLUE, alpha=0.7, label="after")
    axes.set(xlabel=label, yticks=[])
    if first:
        axes.legend()


def _pair(axes: Axes, sets: dict[str, Floats], device: StatedDevice) -> None:
    """Draw the pair of unknowns that is most correlated."""
    names = list(sets)
    if len(names) < 2:
        axes.set_axis_off()
        return
    table = np.abs(np.corrcoef([sets[name] for name in names])) - 2.0 * np.eye(len(names))
    one, two = np.unravel_index(int(table.argmax()), table.shape)
    x, x_label = _scaled(names[int(one)], sets[names[int(one)]], device)
    y, y_label = _scaled(names[int(two)], sets[names[int(two)]], device)
    axes.plot(x, y, ".", color=style.BLUE, markersize=2.5)
    axes.set(xlabel=x_label, ylabel=y_label)


def _times(axes: Axes, found: Calibration) -> None:
    """Draw the predicted and the observed time of each trial; a failure stands at the top."""
    quantiles = 1e3 * found.fit.times
    known = quantiles[np.isfinite(quantiles)]
    observed = np.array([np.nan if t.time is None else 1e3 * t.time for t in found.trials])
    top = 1.3 * float(np.nanmax(np.concatenate([known, observed, [1.0]])))
    low, middle, high = np.minimum(quantiles, top).T
    rows = np.array([each.row for each in found.trials])
    axes.errorbar(rows, middle, [middle - low, high - middle], fmt="_", color=style.BLUE,
                  label="predicted, 5 to 95 %")  # fmt: skip
    fails = np.isnan(observed)
    axes.plot(rows, observed, "o", color=style.VERMILLION, label="observed")
    if fails.any():
        at = np.full(fails.sum(), top)
        axes.plot(rows[fails], at, "X", color=style.VERMILLION, label="failed")
    axes.set(xlabel="row of the table", ylabel="alignment time (ms)")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
