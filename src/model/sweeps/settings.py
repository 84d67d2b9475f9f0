"""Settings and starts of runs, as the configuration and plans state them."""

from dataclasses import asdict
from typing import Annotated, Literal

from pydantic import Field, model_validator

from model.physics.approach import Start
from model.physics.parameters import Shape, check_name
from model.physics.variants import VARIANT_NAMES, Variants
from model.runs.settings import SCENES, Settings
from model.sweeps.axes import Strict, Tolerance


class RunSettings(Strict):
    """Settings of every run of the study: the fields of ``Settings`` that it may state."""

    readings: Literal["consistent", "printed"] | dict[str, Literal["consistent", "printed"]]
    """Variant of the equations, or the variant of each reading by its name."""
    horizon: float = Field(gt=0.0)
    """Latest time τ of a run."""
    tolerance: Tolerance
    """Local error of a step."""
    start: Start = "simultaneous"
    """Press and vibration set in together, or the part rests under the press before it vibrates."""
    scene: Literal["alignment", "insertion"] = "alignment"
    """Contacts that are modelled; runs of the scene insertion end when the part is inserted."""
    shape: Shape | None = Field(default=None, exclude_if=lambda v: v is None)
    """Shape of part and hole; by default the paper's, square."""
    insertion_depth: float | None = Field(default=None, gt=0.0, exclude_if=lambda v: v is None)
    """Depth at which a part counts as inserted; by default half of what the press reaches."""

    @model_validator(mode="after")
    def _fit_together(self) -> "RunSettings":
        if isinstance(self.readings, dict):
            for name in self.readings:
                check_name(name, VARIANT_NAMES, "reading")
        _ = self.settings  # a pressed start needs the consistent readings, a depth its scene
        return self

    @classmethod
    def of(cls, settings: Settings) -> "RunSettings":
        """Return the settings of runs as the study states them."""
        stated = {name: getattr(settings, name) for name in cls.model_fields}
        named = {"readings": asdict(settings.readings), "scene": settings.scene.name}
        named["start"] = settings.start or "simultaneous"
        return cls(**stated | named)

    @property
    def settings(self) -> Settings:
        """Settings as ``simulate`` and ``align`` take them."""
        if isinstance(self.readings, dict):
            readings = Variants(**self.readings)
        else:
            readings = getattr(Variants, self.readings)()
        stated = {name: getattr(self, name) for name in type(self).model_fields}
        return Settings(**stated | {"readings": readings, "scene": SCENES[self.scene]})


class Ensemble(Strict):
    """Initial conditions from all of which a reliable part aligns; see sweeps/starts.py."""

    phases: int = Field(default=16, ge=1)
    """Number of equidistant phases of the excitation at touch-down."""
    tilts: list[Annotated[float, Field(gt=0.0)]] = Field(default=[1.0, 3.0], min_length=1)
    """Initial tilts, in units of the device's ``initial_tilt``."""
    every: int = Field(default=8, ge=1)
    """In a map they are tried at every so many nodes along both axes."""
