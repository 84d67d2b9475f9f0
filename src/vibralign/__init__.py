"""vibralign: will a vibrated peg align with its hole, how fast, how safely?

>>> import vibralign
>>> vibralign.simulate(vibralign.baseline()).outcome
<Outcome.ALIGNED: 0>
"""

import importlib
import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.device.assess import assess as assess
    from model.device.design import Design as Design
    from model.device.design import design as design
    from model.device.reliability import DeviceResults as DeviceResults
    from model.device.yields import Yield as Yield
    from model.device.yields import yield_of as yield_of
    from model.show.si import readable as readable
    from model.study.config import baseline as baseline
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
from model import *  # noqa: E402, F403
from model import __all__ as _of_model  # noqa: E402
from model.sweeps.version import version as _version  # noqa: E402

__version__ = _version()

# Imported when they are used: they need the extra `study`, or take half a second.
_LATER = {
    "Design": "model.device.design",
    "DeviceResults": "model.device.reliability",
    "Yield": "model.device.yields",
    "assess": "model.device.assess",
    "baseline": "model.study.config",
    "design": "model.device.design",
    "readable": "model.show.si",
    "sweep": "vibralign.studies",
    "yield_of": "model.device.yields",
}
__all__ = [*_of_model, *_LATER]  # noqa: PLE0604 - names


def __getattr__(name: str) -> Any:
    if name not in _LATER:
        raise AttributeError(f"module 'vibralign' has no attribute {name!r}")
    try:
        return getattr(importlib.import_module(_LATER[name]), name)
    except ModuleNotFoundError as error:
        raise ImportError(
            f"vibralign.{name} needs {error.name}, not installed: pip install 'vibralign[study]'"
        ) from error


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
