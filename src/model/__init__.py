"""vibralign: vibratory alignment of a peg with a hole, simulated, mapped and reproduced.

>>> from model import simulate
>>> from model.study.config import baseline
>>> simulate(baseline().replace(press_force=2.0, tilt_stiffness=10.0)).outcome
<Outcome.ALIGNED: 0>
"""

from model.device import StatedDevice, load_device
from model.device.reliability import reliable_at
from model.device.runs import align, simulate
from model.events.insertion import INSERTION
from model.events.outcomes import Outcome, Reason
from model.events.scenes import ALIGNMENT, PRINTED_CONTACTS, SUSPENDED, Scene
from model.physics.parameters import Batch, Parameters
from model.physics.variants import Variants
from model.runs.align import Alignments
from model.runs.settings import Settings
from model.runs.simulate import Trajectory

Readings = Variants  # the name in the API

__all__ = [
    "ALIGNMENT",
    "INSERTION",
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
    "StatedDevice",
    "Trajectory",
    "Variants",
    "align",
    "load_device",
    "reliable_at",
    "simulate",
]
