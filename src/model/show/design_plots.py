"""Draw the settings that a design tried: margin against time, with the front."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from model.show import style


def draw_front(dataset: xr.Dataset) -> Figure:
    """Draw every setting with which all devices go in, and the front of time and margin."""
    with style.context():
        figure = style.new_figure(height=9.0 * style.CENTIMETRE)
        axes = figure.subplots()
        time, margin = 1e3 * dataset["time"].values, dataset["margin"].values
        all_in = dataset["share"].values == 1.0
        axes.plot(
            time[all_in], margin[all_in], "o", color=style.SKY_BLUE, markersize=3, label="tried"
        )
        front = np.flatnonzero(dataset["front"].values)
        front = front[np.argsort(time[front])]
        axes.plot(
            time[front], margin[front], "-s", color=style.VERMILLION,
            label="front, within the limits", drawstyle="steps-post",
        )  # fmt: skip
        best = int(dataset.attrs["recommended"])
        axes.plot(time[best], margin[best], "*", color=style.BLACK, markersize=12, label="chosen")
        axes.set_xlabel("longest alignment time within the tolerances (ms)")
        axes.set_ylabel("nearest failure (tolerances)")
        axes.set_ylim(bottom=0.0, top=3.2)
        axes.legend(loc="lower right")
        return figure
