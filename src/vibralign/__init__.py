"""vibralign: will a vibrated peg align with its hole, how fast, how safely?

>>> import vibralign
>>> vibralign.simulate(vibralign.baseline()).outcome
<Outcome.ALIGNED: 0>

The rooms, each of which imports only from those above it, and from the package ``model``:

- ``device``: device files, their quantities and units, runs of devices in SI units.
- ``answers``: assessment, design, yield, maps, and the assumptions they rest on.
- ``plots``: style and drawings of runs, curves and maps; the device sheet.
- ``explorer``: the page that runs a device live.
- ``commands``: the command ``vibralign``.
"""

import importlib
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vibralign.answers.assess import assess as assess
    from vibralign.answers.design import Design as Design
    from vibralign.answers.design import design as design
    from vibralign.answers.reliability import DeviceResults as DeviceResults
    from vibralign.answers.si import readable as readable
    from vibralign.answers.yields import Yield as Yield
    from vibralign.answers.yields import yield_of as yield_of
    from vibralign.studies import sweep as sweep


def _load_model() -> None:
    """Import the package ``model`` beside this one, also where another module has its name.

    Raises:
        ImportError: another ``model`` has been imported before.
    """
    own = Path(__file__).parents[1] / "model" / "__init__.py"
    if "model" in sys.modules:
        other = getattr(sys.modules["model"], "__file__", None)
        if other is None or Path(other).resolve() != own.resolve():
            raise ImportError(
                f"{other}: has the name of the package `model`, of which vibralign is made: rename "
                "it, or import vibralign first"
            )
        return
    spec = importlib.util.spec_from_file_location("model", own)
    assert spec is not None  # noqa: S101 - a file of Python
    assert spec.loader is not None  # noqa: S101
    sys.modules["model"] = module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules["model"]
        raise


_load_model()
# ruff: noqa: E402
from model.events.insertion import INSERTION
from model.events.outcomes import Outcome, Reason
from model.events.scenes import ALIGNMENT, PRINTED_CONTACTS, SUSPENDED, Scene
from model.physics.parameters import Batch, Parameters
from model.physics.variants import Variants
from model.runs.align import Alignments
from model.runs.settings import Settings
from model.runs.simulate import Trajectory
from model.sweeps.version import version as _version
from vibralign.answers.reliability import reliable_at
from vibralign.device import StatedDevice, load_device
from vibralign.device.paper import baseline
from vibralign.device.runs import align, simulate

Readings = Variants  # the name in the API

__version__ = _version()

# Imported when they are used, because they take half a second.
_LATER = {
    "Design": "vibralign.answers.design",
    "DeviceResults": "vibralign.answers.reliability",
    "Yield": "vibralign.answers.yields",
    "assess": "vibralign.answers.assess",
    "design": "vibralign.answers.design",
    "readable": "vibralign.answers.si",
    "sweep": "vibralign.studies",
    "yield_of": "vibralign.answers.yields",
}
__all__ = [
    "ALIGNMENT",
    "INSERTION",
    "PRINTED_CONTACTS",
    "SUSPENDED",
    "Alignments",
    "Batch",
    "Design",
    "DeviceResults",
    "Outcome",
    "Parameters",
    "Readings",
    "Reason",
    "Scene",
    "Settings",
    "StatedDevice",
    "Trajectory",
    "Variants",
    "Yield",
    "align",
    "assess",
    "baseline",
    "design",
    "load_device",
    "readable",
    "reliable_at",
    "simulate",
    "sweep",
    "yield_of",
]


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'vibralign' has no attribute {name!r}")
    return getattr(importlib.import_module(_LATER[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
