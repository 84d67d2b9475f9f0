"""The study as data: the files in config/, checked before anything is computed."""

from model.study.config.base import ConfigError
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
    check_files,
    check_study,
    load_study,
    read_study,
    study_files,
    study_path,
)
from model.study.config.study import Study

__all__ = [
    "COMPUTED", "CURVES", "FIGURES", "GRIDDED", "HISTORIES", "MAPS", "SCHEMATICS", "ConfigError",
    "Curves", "Map", "Study", "baseline", "check_files", "check_study", "load_study", "read_study",
    "study_files", "study_path",
]  # fmt: skip
