"""Interface of a section: the results it reads, what it returns, and its text and tables.

A section function takes ``Results``, from which it reads its data and pictures, and returns a
``Section``. Its template prints the ``content`` below a heading that the page writes; macros for
pictures and tables are in ``section.html.j2``::

    {% from "section.html.j2" import picture, table %}
"""

import base64
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from markupsafe import Markup, escape

from model.physics.parameters import FIELDS
from model.sweeps.io import read_dataset
from study.config.study import Study
from vibralign.plots.words import number, symbol_parts


@dataclass(frozen=True)
class Picture:
    """An embedded picture."""

    place: str  # its path below the results root, without extension
    caption: str  # plain text below it
    alternative: str  # plain text for readers who cannot see it
    data: Markup  # its content as a data URL
    size: tuple[int, int]  # width and height in pixels


@dataclass(frozen=True)
class Table:
    """A table of the page; a column whose name begins with ">" is numeric and set to the right."""

    columns: Sequence[str]
    rows: Sequence[Sequence[object]]


@dataclass(frozen=True)
class Section:
    """One section of the page; the rest of one with a lead is folded."""

    anchor: str  # the address of its heading on the page, also its id
    title: str
    template: Path  # the file that prints ``content``, the only names it may use
    content: Mapping[str, object]
    lead: str = ""  # the finding in a sentence or two


class Results:
    """Reader of the results root, which records every file that a section reads.

    ``study`` is the configuration that the results were computed with; ``live`` is True if
    explorer.html stands beside the page.
    """

    def __init__(self, root: Path, study: Study, *, live: bool = False) -> None:
        self.root, self.study, self.live = root, study, live
        self.inputs: list[Path] = []  # every file read so far
        self._datasets: dict[str, xr.Dataset] = {}

    def file(self, place: str) -> Path:
        """Return the path of a file, named by its path below the root."""
        path = self.root / place
        if not path.is_file():
            raise ValueError(f"the report needs {path}: build it")
        if path not in self.inputs:
            self.inputs.append(path)
        return path

    def dataset(self, place: str) -> xr.Dataset:
        """Read a netCDF file, named as in ``file``."""
        if place not in self._datasets:
            self._datasets[place] = read_dataset(self.file(place))
        return self._datasets[place]

    def picture(self, place: str, caption: str, alternative: str | None = None) -> Picture:
        """Read a PNG picture, named by its path below the root without extension."""
        content = self.file(f"{place}.png").read_bytes()
        # The header of every PNG has its size from byte 16 on.
        size = int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
        data = base64.b64encode(content).decode("ascii")
        address = Markup(f"data:image/png;base64,{data}")  # noqa: S704  (base64 needs no escape)
        return Picture(place, caption, alternative or caption, address, size)


# --- Text ---------------------------------------------------------------------------------------


def symbol(text: str) -> Markup:
    """Return a symbol of ``parameters.FIELDS`` as HTML."""
    head, index = symbol_parts(text)
    letter = Markup("<i>{}</i>").format(head)
    return letter + Markup("<sub>{}</sub>").format(index) if index else letter


def subscripts(text: str) -> Markup:
    """Return plain text as HTML in which K_X1 has a subscript."""
    return Markup(re.sub(r"\b(\w)_(\w+)", r"\1<sub>\2</sub>", str(escape(text))))  # noqa: S704


def link(words: str, address: str) -> Markup:
    """Return a link that stays on one line."""
    return Markup('<a class="nobreak" href="{}">{}</a>').format(address, words)


_LISTED = 8  # most values of a varied parameter that are listed one by one


def value_of(name: str, value: float | None) -> str:
    """Return the value of a parameter, or what it is derived from."""
    if value is None or math.isnan(value):
        return f"as {FIELDS[name].derived}"
    return number(value)


def values_of(dataset: xr.Dataset, name: str) -> str:
    """Return the values of a parameter in a dataset: "5, 7, 10", or "0.25 to 10, 240 values"."""
    values = dataset[name].values
    if values.ndim == 0:
        return value_of(name, float(values))
    if values.size <= _LISTED:
        return ", ".join(number(value) for value in values)
    return f"{number(values[0])} to {number(values[-1])}, {values.size} values"


def assignments(values: Iterable[tuple[str, str]]) -> Markup:
    """Return (parameter, value) pairs as "f0 = 3, μ = 0.1", each kept on one line."""
    return Markup(", ").join(
        Markup("<span class=nobreak>{} = {}</span>").format(symbol(FIELDS[name].symbol), value)
        for name, value in values
    )


def settings_of(values: Mapping[str, float]) -> Markup:
    """Return parameter values as ``assignments`` prints them."""
    return assignments((name, number(value)) for name, value in values.items())
