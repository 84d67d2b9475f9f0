"""The study as data: the files in config/, checked before anything is computed."""

from study.config.base import ConfigError
from study.config.figures import Curves, Map
from study.config.load import (
    check_files,
    check_study,
    load_study,
    read_study,
    study_files,
    study_path,
)
from study.config.study import Study

__all__ = [
    "ConfigError", "Curves", "Map", "Study", "check_files", "check_study", "load_study",
    "read_study", "study_files", "study_path",
]  # fmt: skip
