"""The whole study: its sections as one, and the parameters that each figure, run and case holds."""

from typing import Literal

from pydantic import Field, model_validator

from model.physics.parameters import Parameters, check_name
from model.physics.readings import READING_NAMES, Readings
from model.runs.settings import Settings
from model.study.config.accuracy import Accuracy
from model.study.config.base import ParameterValues, Strict, Text, Tolerance
from model.study.config.claims import ClaimRun, ContactStiffness
from model.study.config.figures import (
    FIGURES,
    LARGEST_MISALIGNMENT,
    MAPS,
    FigureSpec,
    Map,
    Maps,
    Plane,
)
from model.study.config.identification import Identification
from model.study.config.methods import HardCases, Precision


class RunSettings(Strict):
    """How every run of the study is computed."""

    readings: Literal["consistent", "printed"] | dict[str, Literal["consistent", "printed"]]
    horizon: float = Field(gt=0.0)
    tolerance: Tolerance

    @model_validator(mode="after")
    def _readings_exist(self) -> "RunSettings":
        if isinstance(self.readings, dict):
            for name in self.readings:
                check_name(name, READING_NAMES, "reading")
        return self

    @property
    def settings(self) -> Settings:
        """The form that ``simulate`` and ``align`` take."""
        if isinstance(self.readings, dict):
            readings = Readings(**self.readings)
        else:
            readings = getattr(Readings, self.readings)()
        return Settings(readings=readings, horizon=self.horizon, tolerance=self.tolerance)


class Study(Strict):
    """The whole study; see config/."""

    results_root: Text
    settings: RunSettings
    structure: ParameterValues
    operating_point: ParameterValues
    figures: dict[str, FigureSpec]
    maps: Maps
    accuracy: Accuracy
    precision: Precision
    identification: Identification
    hard_cases: HardCases
    claims_runs: dict[str, ClaimRun]
    contact_stiffness: ContactStiffness

    @model_validator(mode="after")
    def _figures_exist(self) -> "Study":
        for name in self.figures:
            check_name(name, FIGURES, "figure")
        missing = [name for name in FIGURES if name not in self.figures]
        if missing:
            raise ValueError(f"figures: missing {', '.join(missing)}")
        for name in self.identification.law.run_counts:
            check_name(name, tuple(self.claims_runs), "run of the claims")
        twice = sorted(set(self.structure) & set(self.operating_point))
        if twice:
            raise ValueError(f"{', '.join(twice)}: stated in both structure and operating_point")
        return self

    @property
    def baseline(self) -> Parameters:
        """The device at its default operating point."""
        return Parameters(**self.structure, **self.operating_point)

    def parameters(self, figure: str) -> Parameters:
        """What a figure holds, before it sweeps anything."""
        return self.baseline.replace(**self.figures[figure].held)

    def plane(self, name: str) -> Plane | Map:
        """A map's ranges and wording: a figure's, one of ``maps.planes``, "largest_misalignment".

        Raises:
            ValueError: no map of that name.
        """
        check_name(name, self.map_names, "map")
        if name == LARGEST_MISALIGNMENT:
            return self.maps.largest_misalignment
        found = self.maps.planes.get(name) or self.figures[name]
        assert isinstance(found, (Plane, Map)), name  # noqa: S101  (checked with the figures)
        return found

    @property
    def map_names(self) -> tuple[str, ...]:
        """Every map of the study, those of the paper first."""
        return *MAPS, *self.maps.planes, LARGEST_MISALIGNMENT

    def claim_parameters(self, name: str) -> Parameters:
        """What a run of the claims ledger holds, before it sweeps anything."""
        run = self.claims_runs[name]
        parameters = self.parameters(run.figure)
        return parameters.replace(**run.changes(parameters.half_width, parameters.clearance))

    def case(self, name: str) -> Parameters:
        """The operating point of a case: what its figure holds, and what the case adds."""
        case = self.precision.cases[name]
        return self.parameters(case.figure).replace(**case.at)
