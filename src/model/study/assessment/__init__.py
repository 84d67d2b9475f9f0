"""Assessment of a device: verdict, bases, leeways, yield and what is to blame for failures."""

from model.study.assessment.assess import Assessment, BaseVerdict, assess, reliable_at
from model.study.assessment.leeways import Leeway, Nearest
from model.study.assessment.yields import Yield, yield_of

__all__ = [
    "Assessment",
    "BaseVerdict",
    "Leeway",
    "Nearest",
    "Yield",
    "assess",
    "reliable_at",
    "yield_of",
]
