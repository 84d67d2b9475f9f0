"""Page with the accepted picture of a figure beside the new one: a warning, not a verdict.

Pictures depend on fonts and on the release of matplotlib; plotted data are compared by numbers
(artists.py).
"""

import base64
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
from matplotlib.image import imread

from model.tracking.provenance import write_text

_VISIBLE = 2.0 / 255.0  # root mean square difference of the colours that an eye may notice


def differing_pictures(root: Path, reference: Path, figures: Sequence[str]) -> dict[str, str]:
    """Return the difference of each picture that differs from the accepted one, by its name."""
    found = {}
    for name in figures:
        accepted, drawn = reference / f"{name}.png", root / "figures" / f"{name}.png"
        if not accepted.is_file() or not drawn.is_file():
            continue
        old, new = imread(accepted), imread(drawn)
        if old.shape != new.shape:
            found[name] = f"{old.shape[1]} × {old.shape[0]} became {new.shape[1]} × {new.shape[0]}"
        else:
            distance = float(np.sqrt(np.mean((np.asarray(new) - np.asarray(old)) ** 2)))
            if distance > _VISIBLE:
                found[name] = f"colours differ by {100.0 * distance:.2g} % in the mean"
    return found


def write_page(found: dict[str, str], root: Path, reference: Path) -> Path:
    """Write ``comparison.html`` in the results root and return its path."""
    rows = "".join(
        f"<h2>{escape(name)}: {escape(words)}</h2><div>{_image(reference / f'{name}.png')}"
        f"{_image(root / 'figures' / f'{name}.png')}</div>"
        for name, words in found.items()
    )
    style = "div{display:flex;gap:1rem}img{width:50%}body{font:1rem/1.5 sans-serif;margin:2rem}"
    page = root / "comparison.html"
    write_text(
        "<!DOCTYPE html><html lang=en><meta charset=utf-8><title>Figures that look different"
        f"</title><style>{style}</style><h1>Accepted on the left, as now drawn on the right</h1>"
        f"{rows}</html>\n",
        page,
    )
    return page


def _image(path: Path) -> str:
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{escape(path.stem)}" src="data:image/png;base64,{data}">'
