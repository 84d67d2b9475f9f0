"""Figures of the paper and further maps: titles, parameters held and parameters varied.

A figure is known by what config/config.yaml states of it under ``figures``: its name and its kind.
"""

from typing import Annotated, Literal

from pydantic import Discriminator, Field

from model.physics.parameters import Shape
from model.sweeps.axes import Axis, Family, Strict
from model.sweeps.settings import Ensemble
from study.config.base import ParameterValues, Text


class FigureBase(Strict):
    """Wording of a figure, and its parameters that differ from the operating point."""

    title: Text
    """Title of the figure."""
    caption: Text
    """Caption: the paper's statement on the figure."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters held at other values than the operating point's."""

    @property
    def varied(self) -> tuple[Axis | Family, ...]:
        """What the figure varies, slowest first."""
        return ()


class Schematic(FigureBase):
    """A drawing of the model (Figs. 1 to 4)."""

    kind: Literal["schematic"]
    """Kind of the figure: a drawing, nothing is computed."""


class History(FigureBase):
    """One trajectory over time (Fig. 5)."""

    kind: Literal["history"]
    """Kind of the figure: one trajectory over time."""


class Curves(FigureBase):
    """Alignment duration over one parameter, a curve for each value of another (Figs. 6 to 12)."""

    kind: Literal["curves"]
    """Kind of the figure: alignment time over one parameter."""
    swept: Axis
    """Parameter along each curve."""
    family: Family
    """Parameter that differs between curves."""
    chunks: int = Field(ge=1, le=64)
    """Number of jobs that the points are divided among."""

    @property
    def varied(self) -> tuple[Axis | Family, ...]:
        """What the figure varies, slowest first."""
        return self.family, self.swept


class Plane(FigureBase):
    """Outcome and duration over two parameters."""

    x: Axis
    """Parameter along the horizontal axis."""
    y: Axis
    """Parameter along the vertical axis."""
    shape: Shape | None = Field(default=None, exclude_if=lambda v: v is None)
    """Shape of part and hole, if it is not the paper's, square."""
    chunks: int = Field(ge=1, le=1000)
    """Number of jobs that the points are divided among."""

    @property
    def varied(self) -> tuple[Axis | Family, ...]:
        """What the map varies, slowest first."""
        return self.y, self.x


class Map(Plane):
    """A map that is a figure of the paper (Figs. 13 and 14)."""

    kind: Literal["map"]
    """Kind of the figure: outcome and alignment time over two parameters."""


FigureSpec = Annotated[Schematic | History | Curves | Map, Discriminator("kind")]
KINDS = ("schematic", "history", "curves", "map")


class Jamming(Strict):
    """Runs with the contacts inside the slot; see model/sweeps/sweep.py."""

    held: ParameterValues = Field(default_factory=dict)
    """Parameters held at other values than the operating point's."""
    clearance: Family
    """Clearances, a panel each."""
    tilt_stiffness: Axis
    """Tilt stiffness; it varies the tilt at entry."""
    friction: Axis
    """Friction."""

    @property
    def varied(self) -> tuple[Axis | Family, ...]:
        """What the runs vary, slowest first."""
        return self.clearance, self.tilt_stiffness, self.friction


class Maps(Strict):
    """Stability maps that are no figures of the paper, and the starts that all maps try."""

    ensemble: Ensemble = Ensemble()
    """Initial conditions of the test for reliable alignment."""
    planes: dict[str, Plane]
    """Maps that are not in the paper, by name."""
