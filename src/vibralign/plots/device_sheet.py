"""Device sheet: an HTML page with its pictures, which prints on two A4 pages."""

import base64
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from model.physics.geometry import resting_height
from model.physics.parameters import constants_of
from model.runs.simulate import Trajectory
from vibralign.answers.si import named_words, readable, written_words
from vibralign.device import StatedDevice
from vibralign.device.base import BASE
from vibralign.device.mouth import GRIPPER_TILT, MOUTH
from vibralign.plots import style
from vibralign.plots.history import trajectory
from vibralign.plots.maps import Handle, stability_map
from vibralign.plots.pose import Pose
from vibralign.plots.templates import templates

MODEL_LIMITS = (
    "It is a model of one plane: a round part may also turn about the other axis.",
    "Friction is dry, with one coefficient for rest and motion; springs and dampers are linear.",
    "The base is a spring with a damper at the contact, and moves nowhere else.",
    "A part is in at half of what the press reaches, or at --insertion-depth; deeper is unknown.",
    "The robot holds still: no path error, no control of force.",
)


def render(
    stated: StatedDevice,
    verdict: tuple[str, bool],
    groups: Mapping[str, Sequence[str]],
    run: Trajectory,
    map_data: xr.Dataset,
    made_by: str,
) -> str:
    """Return the page; the same bytes for the same contents.

    Args:
        stated: the device.
        verdict: the headline, and whether it is good.
        groups: the assessment as printed: lines by title.
        run: one run over time.
        map_data: stability map of the device, in SI units.
        made_by: the footer: file, changes of its values, version of the program.
    """
    with style.context():
        pictures = {
            "device": _picture(_drawing(stated)),
            "map": _picture(device_map(stated, map_data)),
            "run": _picture(trajectory(run, stated.units)),
        }
    return (
        templates(Path(__file__).parent)
        .get_template("device_sheet.html.j2")
        .render(
            name=stated.source.stem,
            verdict=verdict,
            groups=groups,
            made_by=made_by,
            pictures=pictures,
            quantities=_quantities(stated),
            limits=MODEL_LIMITS,
        )
    )


def _picture(figure: Figure) -> str:
    """Return a figure as the address of an image: SVG, with letters as paths."""
    with style.context(), mpl.rc_context({"svg.fonttype": "path"}):
        file = io.BytesIO()
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    return "data:image/svg+xml;base64," + base64.b64encode(file.getvalue()).decode()


def _quantities(stated: StatedDevice) -> list[tuple[str, str, str]]:
    rows = []
    named = {*stated.resolved({}), *MOUTH, *BASE}
    shown = {**stated.values, **stated.quantities}
    for name, value in ((name, each) for name, each in shown.items() if name in named):
        spread = ""
        if tolerance := stated.tolerances.get(name):
            width = written_words(name, tolerance.around(value), stated)
            spread = f"{tolerance.sign} {width}"
        rows.append((name.replace("_", " "), written_words(name, value, stated), spread))
    return rows + ([("materials", stated.materials, "")] if stated.materials else [])


def _drawing(stated: StatedDevice) -> Figure:
    """Draw the part beside the hole at the start, to scale, and where misalignment is measured."""
    device = stated.device
    p = constants_of(device.parameters, stated.shape)
    pose = Pose(p.misalignment, resting_height(p), p.initial_tilt, p)
    length = 1e3 * device.units.amplitude
    corners = length * np.array(pose.corners())
    edge = length * device.parameters.slot_half_width
    width = length * device.parameters.half_width
    depth = 1.2 * width
    figure = style.new_figure(6.0 * style.CENTIMETRE, 8.5 * style.CENTIMETRE)
    axes = figure.subplots()
    look: Any = {"facecolor": "#DDDDDD", "edgecolor": style.BLACK, "linewidth": 0.8}
    axes.add_patch(Rectangle((-edge - 1.5 * width, -depth), 1.5 * width, depth, **look))
    axes.add_patch(Rectangle((edge, -depth), 1.5 * width, depth, **look))
    axes.add_patch(Polygon(corners, closed=True, facecolor="#BFD9EA", edgecolor=style.BLUE))
    axes.plot([0, 0], [-depth, corners[:, 1].max()], color=style.GREY, linestyle="-.", lw=0.6)
    middle, down = 1e3 * stated.quantities["misalignment"], -0.5 * depth
    axes.plot([0, middle], [down, down], color=style.VERMILLION, marker="|", lw=0.8)
    label = f"misalignment {middle:.3g} mm"
    axes.annotate(label, (middle, down), (4, 0), "data", textcoords="offset points", fontsize=6)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("mm")
    axes.set_ylabel("mm")
    axes.autoscale_view()
    return figure


def device_map(stated: StatedDevice, dataset: xr.Dataset) -> Figure:
    """Draw the map of the device, with a cross at the device and a box of its tolerances."""
    drawn = readable(dataset)
    values: Mapping[str, float] = {**stated.values, **stated.quantities}
    y_name, x_name = map(str, dataset["outcome"].dims)
    places = []
    for name in (x_name, y_name):
        one = float(drawn[name][-1] / dataset[name][-1])
        own, tolerance = values[name], stated.tolerances.get(name)
        wide = 0.0 if tolerance is None else tolerance.around(own)
        places.append((one * (own - wide), one * 2.0 * wide, one * own))
    (left, wide, x), (bottom, high, y) = places

    def mark(axes: Axes) -> list[Handle]:
        cross: Any = {"linestyle": "none", "marker": "P", "markersize": 8, "label": "as stated"}
        handles: list[Handle] = [
            *axes.plot(x, y, color=style.VERMILLION, markeredgecolor="white", **cross)
        ]
        if wide or high:
            look: Any = {"fill": False, "edgecolor": style.VERMILLION, "linewidth": 1.5}
            box = Rectangle((left, bottom), wide, high, label="its tolerances", **look)
            handles.append(axes.add_patch(box))
        return handles

    figure = stability_map(dataset, mark)
    start = f"lowered {stated.approaches()[0]}" if stated.approaches() else "sudden start"
    words = named_words({name: values[name] for name in ("phase", GRIPPER_TILT)}, stated)
    words = f"{stated.source.name}, {start}; one start: {words}"
    if "reliable" in dataset and not dataset["reliable"].any():
        words += "; from every start it goes in nowhere"
    with style.context():
        figure.axes[0].set_title(fill(words, 70))
    return figure
