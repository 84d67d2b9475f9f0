"""An animated run: the explorer's page with this run alone."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from model.runs.trace import COLUMNS, Trace
from model.show.explorer.page import build_page, packed

_MOST_ROWS = 20_000  # of a track in a page; events are kept


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
