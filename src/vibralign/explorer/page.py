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

from model.runs.in_browser import Module

SCRIPTS = (
    "engine", "amounts", "state", "drawing", "plots", "map", "words", "runs", "controls", "main"
)  # fmt: skip
_WORKER = ("engine", "worker")
_HERE = Path(__file__).resolve().parent


def packed(data: bytes) -> str:
    """Return compressed bytes as text; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def build_page(model: Mapping[str, Any], module: Module) -> str:
    """Return the page of a model (content.py), with the engine."""
    engine = {
        "engine": packed(module.binary),
        "worker": "\n".join(_text(f"page.{name}.js") for name in _WORKER),
    }
    stated = json.dumps({**model, **engine}, ensure_ascii=False, allow_nan=False)
    parts = {
        "title": html.escape(model["title"]),
        "footer": html.escape(model["footer"]),
        "style": _text("page.css"),
        "model": stated.replace(
            "<", "\\u003c"
        ),  # no name of a file ends the script, or hides its end
        "script": "\n".join(_text(f"page.{name}.js") for name in SCRIPTS),
    }
    page = re.sub("@([a-z]+)@", lambda found: parts[found[1]], _text("page.html"))
    return page.encode("utf-8", "backslashreplace").decode()  # a name may be no text


def _text(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
