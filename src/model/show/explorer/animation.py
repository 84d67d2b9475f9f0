"""An animated run: the explorer's page with this run alone, or pictures of its drawing as a GIF."""

import base64
import io
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from model.runs.shown import COLUMNS, Shown
from model.show.explorer.browser import BROWSERS, browser, find_browser
from model.show.explorer.page import build_page, packed

FRAMES = 80
FRAME_TIME = 0.08  # s
_MOST_ROWS = 20_000  # of a track in a page; events are kept


def run_page(model: Mapping[str, Any], run: Shown) -> str:
    """Return the page of one run; ``model`` is that of its device."""
    track = _thinned(run.track)
    results = {name: None if np.isnan(value) else value for name, value in run.results.items()}
    results["tracked"] = float(len(track))
    stored = {"track": packed(track.astype("<f8").tobytes()), "results": results}
    return build_page({**model, "run": stored}, None)


def run_gif(page: str) -> bytes:
    """Return the drawing of a run's page as an animated GIF.

    Raises:
        ValueError: there is no browser to draw it, or no Pillow to write it.
    """
    path = find_browser()
    if path is None:
        raise ValueError(
            f"a GIF is drawn by a browser, and none of {', '.join(BROWSERS)} is installed: install "
            "one, name it in CHROMIUM, or write .html"
        )
    try:
        from PIL import Image  # noqa: PLC0415 - comes with matplotlib
    except ImportError:
        raise ValueError("a GIF needs Pillow: pip install 'vibralign[plot]'") from None
    with TemporaryDirectory() as folder, browser(path) as shown:
        file = Path(folder, "run.html")
        file.write_text(page, encoding="utf-8")
        shown.open(file.as_uri(), 800, 900)
        shown.wait_for("window.explorer")
        drawn = shown.evaluate(f"explorer.pictures({FRAMES})")
    pictures = [Image.open(io.BytesIO(base64.b64decode(each.partition(",")[2]))) for each in drawn]
    first, *rest = [each.convert("RGB").quantize(64) for each in pictures]
    written = io.BytesIO()
    first.save(
        written, "GIF", save_all=True, append_images=rest, duration=int(1000 * FRAME_TIME), loop=0
    )
    return written.getvalue()


def _thinned(track: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return a long track with fewer rows between its events."""
    if len(track) <= _MOST_ROWS:
        return track
    kept = np.arange(len(track)) % -(-len(track) // _MOST_ROWS) == 0
    at_event = track[:, COLUMNS.index("event")] != 0.0
    kept |= at_event | np.roll(at_event, -1)
    kept[-1] = True
    return track[kept]
