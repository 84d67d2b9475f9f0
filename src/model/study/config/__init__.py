"""The study as data: the files in config/, checked before anything is computed."""

from model.study.config.base import Axis, ConfigError, Family, check_plane
from model.study.config.figures import (
    COMPUTED,
    CURVES,
    FIGURES,
    GRIDDED,
    HISTORIES,
    MAPS,
    SCHEMATICS,
    Curves,
    Map,
)
from model.study.config.load import (
    baseline,
    check_study,
    load_study,
    read_study,
    study_files,
    study_path,
)
from model.study.config.settings import Ensemble, RunSettings
from model.study.config.study import Study

__all__ = [
    "COMPUTED", "CURVES", "FIGURES", "GRIDDED", "HISTORIES", "MAPS", "SCHEMATICS", "Axis",
    "ConfigError", "Curves", "Ensemble", "Family", "Map", "RunSettings", "Study",
    "baseline", "check_plane", "check_study", "load_study", "read_study", "study_files",
    "study_path",
]  # fmt: skip
