"""vibralign: vibratory alignment of a peg with a hole, simulated, mapped and reproduced.

>>> from model import simulate
>>> from model.study.config import baseline
>>> simulate(baseline().replace(press_force=2.0, tilt_stiffness=10.0)).outcome
<Outcome.ALIGNED: 0>
"""

from model.physics.parameters import Batch, Parameters
from model.physics.readings import Readings
from model.physics.scenes import ALIGNMENT, PRINTED_CONTACTS, SUSPENDED, Scene
from model.runs.batch import Alignments, align
from model.runs.settings import Settings
from model.runs.trajectory import Trajectory, simulate
from model.solver.outcomes import Outcome, Reason

__all__ = [
    "ALIGNMENT",
    "PRINTED_CONTACTS",
    "SUSPENDED",
    "Alignments",
    "Batch",
    "Outcome",
    "Parameters",
    "Readings",
    "Reason",
    "Scene",
    "Settings",
    "Trajectory",
    "align",
    "simulate",
]
