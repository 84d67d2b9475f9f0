"""vibralign: will a vibrated peg align with its hole, how fast, how safely?

>>> import vibralign
>>> vibralign.simulate(vibralign.baseline()).outcome
<Outcome.ALIGNED: 0>

The rooms, each of which imports only from those above it, and from the package ``model``:

- ``device``: device files, their quantities and units, runs of devices in SI units.
- ``answers``: assessment, design, yield, maps, and the assumptions they rest on.
- ``known``: devices that are known in part: ranges, trials, and what to measure next.
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
    from model.events.insertion import INSERTION as INSERTION
    from model.events.outcomes import Outcome as Outcome
    from model.events.outcomes import Reason as Reason
    from model.events.scenes import ALIGNMENT as ALIGNMENT
    from model.events.scenes import PRINTED_CONTACTS as PRINTED_CONTACTS
    from model.events.scenes import SUSPENDED as SUSPENDED
    from model.events.scenes import Scene as Scene
    from model.physics.parameters import Batch as Batch
    from model.physics.parameters import Parameters as Parameters
    from model.physics.variants import Variants as Readings
    from model.physics.variants import Variants as Variants
    from model.runs.align import Alignments as Alignments
    from model.runs.settings import Settings as Settings
    from model.runs.simulate import Trajectory as Trajectory
    from vibralign.answers.assess import assess as assess
    from vibralign.answers.design import Design as Design
    from vibralign.answers.design import design as design
    from vibralign.answers.reliability import DeviceResults as DeviceResults
    from vibralign.answers.reliability import reliable_at as reliable_at
    from vibralign.answers.si import readable as readable
    from vibralign.answers.yields import Yield as Yield
    from vibralign.answers.yields import yield_of as yield_of
    from vibralign.device import StatedDevice as StatedDevice
    from vibralign.device import load_device as load_device
    from vibralign.device.paper import baseline as baseline
    from vibralign.device.runs import align as align
    from vibralign.device.runs import simulate as simulate
    from vibralign.doubts import DoubtWarning as DoubtWarning
    from vibralign.known.calibrate import Calibration as Calibration
    from vibralign.known.calibrate import calibrate as calibrate
    from vibralign.known.possible import known_in_part as known_in_part
    from vibralign.known.settings import covering as covering
    from vibralign.studies import sweep as sweep

# The names by their modules, which are imported when a name is used: together they take seconds.
_NAMES = {
    "model.events.insertion": "INSERTION",
    "model.events.outcomes": "Outcome Reason",
    "model.events.scenes": "ALIGNMENT PRINTED_CONTACTS SUSPENDED Scene",
    "model.physics.parameters": "Batch Parameters",
    "model.physics.variants": "Variants",
    "model.runs.align": "Alignments",
    "model.runs.settings": "Settings",
    "model.runs.simulate": "Trajectory",
    "vibralign.answers.assess": "assess",
    "vibralign.answers.design": "Design design",
    "vibralign.answers.reliability": "DeviceResults reliable_at",
    "vibralign.answers.si": "readable",
    "vibralign.answers.yields": "Yield yield_of",
    "vibralign.device": "StatedDevice load_device",
    "vibralign.device.paper": "baseline",
    "vibralign.doubts": "DoubtWarning",
    "vibralign.device.runs": "align simulate",
    "vibralign.known.calibrate": "Calibration calibrate",
    "vibralign.known.possible": "known_in_part",
    "vibralign.known.settings": "covering",
    "vibralign.studies": "sweep",
}
_PLACES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = ["Readings", *_PLACES]  # noqa: PLE0604 - names


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


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return importlib.import_module("model.sweeps.version").version()
    if name == "Readings":  # the name in the API
        return __getattr__("Variants")
    if name == "read_device":
        raise AttributeError("vibralign.read_device: since release 2 write load_device")
    if name not in _PLACES:
        raise AttributeError(f"module 'vibralign' has no attribute {name!r}")
    return getattr(importlib.import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
