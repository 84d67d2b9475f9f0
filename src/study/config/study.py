"""The whole study: its sections, and the parameters of each figure, run and case."""

import re

from pydantic import model_validator

from model.physics.parameters import Parameters, check_name
from model.sweeps.axes import Strict
from model.sweeps.settings import RunSettings
from study.config.accuracy import Accuracy
from study.config.base import ParameterValues, ResultsFolder
from study.config.evidence import Evidence
from study.config.figures import FigureSpec, Jamming, Maps, Plane
from study.config.identification import Identification
from study.config.methods import Precision


class Study(Strict):
    """The whole study; see config/."""

    results_root: ResultsFolder
    """Folder of the results."""
    settings: RunSettings
    """Settings of every run."""
    structure: ParameterValues
    """Parameters of the device."""
    operating_point: ParameterValues
    """Default values of the parameters that figures vary."""
    figures: dict[str, FigureSpec]
    """Figures by name: fig01 to fig14 are those of the paper."""
    maps: Maps
    """Stability maps."""
    accuracy: Accuracy
    """Trials of the integrator's accuracy on random sets."""
    precision: Precision
    """Error against cost: operating points, hard cases, tolerances."""
    identification: Identification
    """The search for the parameters that the paper leaves unstated."""
    evidence: Evidence
    """Random devices and other assumptions, judged by the claims."""
    jamming: Jamming
    """Jamming in the slot over friction, clearance and tilt at entry."""

    @model_validator(mode="after")
    def _names_are_of_one_kind(self) -> "Study":
        for name in self.figures:
            if not re.fullmatch(r"fig\d\d", name):
                raise ValueError(f"figures.{name}: must be named fig and two digits, such as fig15")
        twice = sorted(set(self.structure) & set(self.operating_point))
        if twice:
            raise ValueError(f"{', '.join(twice)}: stated in both structure and operating_point")
        for name in set(self.maps.planes) & set(self.figures):
            raise ValueError(f"maps.planes.{name}: is the name of a figure")
        return self

    def named(self, *kinds: str) -> tuple[str, ...]:
        """Return the names of the figures of some kinds, in order."""
        return tuple(sorted(name for name, spec in self.figures.items() if spec.kind in kinds))

    @property
    def computed(self) -> tuple[str, ...]:
        """Names of the figures that have a dataset: all but the drawings of the model."""
        return self.named("history", "curves", "map")

    @property
    def baseline(self) -> Parameters:
        """Device at its default operating point."""
        return Parameters(**self.structure, **self.operating_point)

    def spec_of(self, name: str) -> FigureSpec | Plane:
        """Return what is stated of a figure or of a further map.

        Raises:
            ValueError: there is no figure or map of this name.
        """
        stated: dict[str, FigureSpec | Plane] = {**self.figures, **self.maps.planes}
        check_name(name, [*stated], "figure or map")
        return stated[name]

    def parameters(self, name: str) -> Parameters:
        """Return the parameters that a figure or map holds; those it varies are the baseline's."""
        return self.baseline.replace(**self.spec_of(name).held)

    def case(self, name: str) -> Parameters:
        """Return the operating point of a case: that of its figure, changed by its own values."""
        case = self.precision.cases[name]
        return self.parameters(case.figure).replace(**case.at)
