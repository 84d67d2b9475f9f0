"""The explorer as one file: template, style and scripts of this folder, with a model inlined.

The scripts are plain and share one scope; ``SCRIPTS`` is their order. The page needs no network.
"""

import base64
import gzip
import html
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from model.engine.track import COLUMNS
from model.runs.in_browser import Module
from model.runs.trace import Trace

SCRIPTS = (
    "engine", "amounts", "state", "drawing", "plots", "map", "words", "runs", "controls", "main"
)  # fmt: skip
_WORKER = ("engine", "worker")
_HERE = Path(__file__).resolve().parent
_MOST_ROWS = 20_000  # of a track in the page of one run, besides its events


def packed(data: bytes) -> str:
    """Return compressed bytes as text; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def build_page(model: Mapping[str, Any], module: Module | None) -> str:
    """Return the page of a model (content.py), with the engine unless it only shows a run."""
    engine: dict[str, Any] = {}
    if module is not None:
        engine = {
            "engine": packed(module.binary),
            "worker": "\n".join(_text(f"page.{name}.js") for name in _WORKER),
        }
    stated = json.dumps({**model, **engine}, ensure_ascii=False, allow_nan=False)
    parts = {
        "title": html.escape(model["title"]),
        "footer": html.escape(model["footer"]),
        "unscripted": _unscripted(model),
        "style": _text("page.css"),
        "model": stated.replace(
            "<", "\\u003c"
        ),  # no name of a file ends the script, or hides its end
        "script": "\n".join(_text(f"page.{name}.js") for name in SCRIPTS),
    }
    page = re.sub("@([a-z]+)@", lambda found: parts[found[1]], _text("page.html"))
    return page.encode("utf-8", "backslashreplace").decode()  # a name may be no text


def _unscripted(model: Mapping[str, Any]) -> str:
    """Return what stands in the page until its scripts run, where they may: outcome and values."""
    lines = ["This page needs JavaScript, which is off or not allowed here. Its device:"]
    if "run" in model:
        outcome = model["outcomes"][int(model["run"]["results"]["outcome"])]
        lines[0] = f"{lines[0].partition(' Its')[0]} Of its run: {outcome}."
    values = model["baseline"]
    cells = (
        (each["words"], f"{values[each['name']]:.4g}", each["si"])
        for each in model["parameters"]
        if values[each["name"]] is not None
    )
    rows = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in cells)
    return (
        f"<p>{html.escape(lines[0])}</p><table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"
    )


def run_page(model: Mapping[str, Any], run: Trace) -> str:
    """Return the page of one run; ``model`` is that of its device."""
    track = _thinned(run.track)
    results = {name: None if np.isnan(value) else value for name, value in run.results.items()}
    results["tracked"] = float(len(track))
    stored = {"track": packed(track.astype("<f8").tobytes()), "results": results}
    return build_page({**model, "run": stored}, None)


def _thinned(track: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Return a long track with fewer rows between its events."""
    if len(track) <= _MOST_ROWS:
        return track
    kept = np.arange(len(track)) % -(-len(track) // _MOST_ROWS) == 0
    at_event = track[:, COLUMNS.index("event")] != 0.0
    kept |= at_event | np.roll(at_event, -1)
    kept[-1] = True
    return track[kept]


def _text(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
