"""The figures of the paper and the maps beside them: what each holds, sweeps and is called.

A new figure is named in a tuple below, and stated under ``figures`` in config/config.yaml.
"""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, model_validator

from model.study.config.base import (
    Axis,
    Family,
    ParameterValues,
    Span,
    Strict,
    Text,
    check_power_of_two,
)

SCHEMATICS = ("fig01", "fig02", "fig03", "fig04")
HISTORIES = ("fig05",)
CURVES = ("fig06", "fig07", "fig08", "fig09", "fig10", "fig11", "fig12")
MAPS = ("fig13", "fig14")
FIGURES = SCHEMATICS + HISTORIES + CURVES + MAPS
GRIDDED = CURVES + MAPS
COMPUTED = HISTORIES + GRIDDED
LARGEST_MISALIGNMENT = "largest_misalignment"  # the map that is not one of outcomes


class FigureBase(Strict):
    """Wording of a figure, and what differs from the operating point."""

    title: Text
    caption: Text
    held: ParameterValues = Field(default_factory=dict)


class Schematic(FigureBase):
    """A drawing of the model (Figs. 1 to 4)."""

    kind: Literal["schematic"]


class History(FigureBase):
    """One trajectory over time (Fig. 5)."""

    kind: Literal["history"]


class Curves(FigureBase):
    """Alignment duration over one parameter, a curve for each value of another (Figs. 6 to 12)."""

    kind: Literal["curves"]
    swept: Axis
    family: Family
    chunks: int = Field(ge=1, le=64)


class Map(FigureBase):
    """Outcome and duration over two parameters (Figs. 13 and 14)."""

    kind: Literal["map"]
    x: Axis
    y: Axis
    chunks: int = Field(ge=1, le=64)


FigureSpec = Annotated[Schematic | History | Curves | Map, Discriminator("kind")]
KIND = (
    dict.fromkeys(SCHEMATICS, "schematic")
    | dict.fromkeys(HISTORIES, "history")
    | dict.fromkeys(CURVES, "curves")
    | dict.fromkeys(MAPS, "map")
)


class Plane(FigureBase):
    """A map over two parameters that is not a figure of the paper."""

    x: Span
    y: Span


class Ensemble(Strict):
    """The starts that a part must align from to count as reliable; see maps.py."""

    phases: int = Field(ge=1)
    tilts: list[Annotated[float, Field(gt=0.0)]] = Field(min_length=1)
    every: int = Field(ge=1)

    @model_validator(mode="after")
    def _can_be_halved(self) -> "Ensemble":
        check_power_of_two("every", self.every)
        return self


class Resolution(Strict):
    """Finest cells along a side of a map, a power of two: of the paper's, and of the others."""

    figures: int = Field(ge=2, le=8192)
    planes: int = Field(ge=2, le=8192)

    @model_validator(mode="after")
    def _can_be_halved(self) -> "Resolution":
        check_power_of_two("figures", self.figures)
        check_power_of_two("planes", self.planes)
        return self


class Maps(Strict):
    """Maps that follow their boundary: those of the paper over their figures' ranges, and more."""

    resolution: Resolution
    chunks: int = Field(ge=1, le=64)
    ensemble: Ensemble
    planes: dict[str, Plane]
    largest_misalignment: Plane
    trials: int = Field(ge=2)

    @model_validator(mode="after")
    def _names_are_new(self) -> "Maps":
        for name in set(self.planes) & {*FIGURES, LARGEST_MISALIGNMENT}:
            raise ValueError(f"planes.{name}: is the name of a map that the study has already")
        return self
