"""Draw the moving picture of README: a peg beside its hole, pressed, and pressed and vibrated.

    python docs/moving_picture.py docs/alignment.gif

Both parts are docs/peg.yaml, followed by the package; only the time is stretched.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from PIL import Image

from vibralign import INSERTION, Parameters, Settings, load_device, simulate
from vibralign.plots import style

# Of the frames HELD show the end; PAUSE milliseconds from one to the next.
FRAMES, HELD, PAUSE = 100, 20, 60
COLOURS = 24
SHOWN = 0.18  # seconds
# In mm: half the picture's width, its depth, the height of the holder.
WIDTH, BELOW, HOLDER = 11.0, 6.0, 48.0


def corners(device: Parameters, x: float, y: float, tilt: float) -> np.ndarray:
    """Return the corners of the part, shape (4, 2)."""
    along = np.array([np.cos(tilt), np.sin(tilt)]) * device.half_width
    up = np.array([-np.sin(tilt), np.cos(tilt)]) * device.half_height
    centre = np.array([x, y])
    return np.array([centre + i * along + j * up for i, j in ((1, -1), (1, 1), (-1, 1), (-1, -1))])


def zigzag(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the points of a spring between two points, shape (9, 2)."""
    along = np.linspace(0.0, 1.0, 9)[:, None]
    sideways = np.array([0, 0, 1, -1, 1, -1, 1, 0, 0])[:, None] * [0.5, 0.0]
    return np.asarray(start + along * (end - start) + sideways)


class Panel:
    """The part over its hole, its start, the holder above, springs between them, and the clock."""

    def __init__(self, axes: Axes, title: str, device: Parameters) -> None:
        slot = device.slot_half_width
        for left in (-WIDTH, slot):
            axes.add_patch(Rectangle((left, -BELOW), WIDTH - slot, BELOW, color="#C9CED6"))
        start = corners(device, device.misalignment, device.half_height, 0.0)
        axes.add_patch(Polygon(start, fill=False, edgecolor=style.GREY, linestyle=":"))
        self.part = Polygon(start, facecolor="#5BA3CF", edgecolor=style.BLACK)
        self.holder = Rectangle((0.0, 0.0), 12.0, 2.5, color="#4A4F57")
        axes.add_patch(self.part)
        axes.add_patch(self.holder)
        self.springs = [axes.plot([], [], color=style.GREY, linewidth=1.0)[0] for _ in range(2)]
        self.clock = axes.text(-WIDTH + 0.4, -BELOW + 0.8, "", fontsize=8)
        self.device = device
        axes.set(xlim=(-WIDTH, WIDTH), ylim=(-BELOW, HOLDER + 5.0), aspect="equal")
        axes.set_title(title)
        axes.set_axis_off()

    def show(self, state: np.ndarray, moved: float, words: str) -> None:
        """Show the part at x, y, tilt, the holder moved along the axis, and the time."""
        at, device = corners(self.device, *state), self.device
        self.part.set_xy(at)
        self.holder.set_xy((device.misalignment - 6.0, HOLDER + moved))
        for spring, top, side in zip(self.springs, at[1:3], (3.5, -3.5), strict=True):
            bottom = np.array([device.misalignment + side, HOLDER + moved])
            spring.set_data(*zigzag(top, bottom).T)
        self.clock.set_text(words)


def main(target: Path) -> None:
    """Write the picture."""
    stated = load_device(Path(__file__).with_name("peg.yaml"), {})
    second = 1.0 / stated.units.time
    settings = Settings(scene=INSERTION, horizon=SHOWN * second, may_settle=False)
    runs = [simulate(stated.changed(frequency=0.0), settings), simulate(stated, settings)]
    times = np.minimum(np.arange(FRAMES) / (FRAMES - HELD), 1.0) * SHOWN

    with style.context():
        figure, frames = Figure(figsize=(4.6, 5.0), dpi=80), []
        canvas, titles = FigureCanvasAgg(figure), ("pressed: it rests", "vibrated: it creeps in")
        places = zip(figure.subplots(1, 2), titles, runs, strict=True)
        panels = [(Panel(axes, title, run.parameters), run) for axes, title, run in places]
        for time in times:
            for panel, run in panels:
                now = min(time * second, run.time[-1])
                state = [np.interp(now, run.time, run.state[:, column]) for column in range(3)]
                moved = -np.sin(run.parameters.frequency * time * second)
                panel.show(np.array(state), moved, f"{1e3 * time:.0f} ms")
            canvas.draw()
            frames.append(Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3]))
    # All frames share the colours of the last, so that what does not move is stored once.
    palette = frames[-1].quantize(COLOURS)
    first, *others = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in frames]
    first.save(target, save_all=True, append_images=others, duration=PAUSE, loop=0, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
