"""Assessment of a device: verdict, bases, leeways, yield and what is to blame for failures."""

from model.study.assessment.assess import Assessment, BaseVerdict, assess
from model.study.assessment.judge import reliable_at
from model.study.assessment.leeways import Leeway, Nearest

__all__ = ["Assessment", "BaseVerdict", "Leeway", "Nearest", "assess", "reliable_at"]
