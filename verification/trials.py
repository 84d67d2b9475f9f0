"""Random parameter sets of `make accuracy`, drawn from the distributions in the configuration.

``accuracy`` runs and judges the trials.
"""

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from model.physics.parameters import Batch, Parameters
from model.sweeps.axes import Plan
from model.sweeps.settings import RunSettings
from study.config.accuracy import Range

if TYPE_CHECKING:
    from study.config.study import Study

TrialName = Literal["error", "settled"]
TRIALS: tuple[TrialName, ...] = ("error", "settled")


class Trial(Plan):
    """A trial as data; the hash of its JSON is its identity.

    Attributes:
        name: "error" or "settled".
        parameters: every parameter, None where it is derived; drawn ones as in the baseline.
        settings: settings of the runs, with the trial's own horizon.
        ranges: distributions of the drawn parameters.
        seed: seed of the draw; the two trials draw different sets.
        sets: number of sets.
        longer: number of horizons for which a settled run is continued.
    """

    name: TrialName
    parameters: dict[str, float | None]
    settings: RunSettings
    ranges: dict[str, Range]
    seed: int
    sets: int
    longer: float

    def batch(self, numbers: NDArray[np.int64]) -> Batch:
        """Return sets by their numbers; a set does not depend on the number of sets drawn."""
        rng = np.random.default_rng([self.seed, TRIALS.index(self.name)])
        draws = rng.random((self.sets, 2, len(self.ranges)))[numbers]
        drawn = {}
        for i, (name, law) in enumerate(self.ranges.items()):
            values = law.low * (law.high / law.low) ** draws[:, 0, i]
            drawn[name] = np.where(draws[:, 1, i] < law.zero, 0.0, values)
        return Batch.of(Parameters(**self.parameters), **drawn)  # type: ignore[arg-type]


def trial_of(study: "Study", name: TrialName) -> Trial:
    """Return a trial of a study."""
    law = study.accuracy
    return Trial(
        name=name,
        parameters=study.baseline.given(),
        settings=study.settings.model_copy(update={"horizon": law.horizon}),
        ranges=law.ranges,
        seed=law.seed,
        sets=law.sets if name == "error" else law.settled.sets,
        longer=law.settled.longer,
    )
