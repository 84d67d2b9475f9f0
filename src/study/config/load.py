"""Reads the configuration, and words a fault as a line: path of the key, value and rule."""

import difflib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ValidationError

from model.sweeps.axes import Strict
from model.sweeps.files import parse_yaml, read_text
from study.config.base import ConfigError
from study.config.checks import faults_of
from study.config.figures import KINDS
from study.config.study import Study


def _every_key(model: type[BaseModel] = Strict) -> set[str]:
    """Return the keys of all sections."""
    return {*model.model_fields}.union(*map(_every_key, model.__subclasses__()))


def _line(error: Mapping[str, Any]) -> str:
    """Return a line for an error of pydantic: path, value, rule; nearest key for an unknown one."""
    names = {str(part) for part in error["loc"]} & set(KINDS)
    place = [str(each) for each in error["loc"] if str(each) not in names and "[" not in str(each)]
    path = ".".join(place) or "(top level)"
    if error["type"] == "extra_forbidden":
        near = difflib.get_close_matches(str(error["loc"][-1]), _every_key(), n=1)
        hint = f"did you mean {near[0]!r}?" if near else "see docs/reference/configuration.md"
        return f"{path}: unknown key; {hint}"
    if error["type"] == "missing":
        return f"{path}: missing"
    value = error["input"]
    if error["type"] in {"int_type", "float_type"} and isinstance(value, str):
        if number := re.fullmatch(r"([-+]?\d+)(\.\d*)?[eE]([-+]?)(\d+)", value):
            whole, part, sign, power = (each or "" for each in number.groups())
            written = f"{whole}{part or '.0'}e{sign or '+'}{power}"
            return f"{path} = {value!r}: is text for YAML: write {written}"
        words = (
            "is text, must be a number; Snakemake makes text of all that stands in braces after "
        )
        return f"{path} = {value!r}: {words}--config: write it into a file, --configfile FILE"
    shown = "" if isinstance(value, (dict, BaseModel)) else f" = {value!r}"
    return f"{path}{shown}: {error['msg'].removeprefix('Value error, ')}"


def check_study(mapping: Mapping[str, Any], source: str = "config") -> Study:
    """Return the study in ``mapping``, checked.

    Raises:
        ConfigError: a line for every fault: path of the key, value and rule.
    """
    try:
        study = Study.model_validate(mapping)
        faults = faults_of(study)
    except ValidationError as invalid:
        faults = list(dict.fromkeys(map(_line, invalid.errors())))
    if faults:
        raise ConfigError("\n".join(f"{source}: {fault}" for fault in faults))
    return study


def _mapping(path: Path) -> dict[str, Any]:
    try:
        mapping = parse_yaml(read_text(path))
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise ConfigError(f"{path}: cannot be read as YAML: {error}") from None
    if not isinstance(mapping, dict):
        raise ConfigError(f"{path}: must be a mapping of keys to values")
    return mapping


def study_files(path: Path) -> list[Path]:
    """Return the files of a study: ``path``, and files beside it that are named after a section."""
    beside = [path.with_name(f"{name}.yaml") for name in Study.model_fields]
    return [path, *(file for file in beside if file != path and file.is_file())]


def read_study(path: Path) -> dict[str, Any]:
    """Return what the files of a study state, as one mapping that is not checked yet.

    A section that ``path`` does not state is read from the file of its name beside it, such as
    maps.yaml. That file must state this section and no other.

    Raises:
        ConfigError: a file that cannot be read, is not YAML, or states another section.
    """
    mapping = _mapping(path)
    for file in study_files(path)[1:]:
        if file.stem not in mapping:
            section = _mapping(file)
            if set(section) != {file.stem}:
                raise ConfigError(f"{file}: must state {file.stem!r}, and no other key at the top")
            mapping |= section
    return mapping


def check_files(paths: Iterable[Path | str]) -> None:
    """Refuse files in which Snakemake reads what is not meant, such as the last of two keys.

    Raises:
        ConfigError: as ``read_study``.
    """
    for path in paths:
        _mapping(Path(path))


def load_study(path: Path) -> Study:
    """Return the study in the YAML file ``path`` and those beside it, checked.

    Raises:
        ConfigError: a file that cannot be read, is not YAML, or breaks a rule.
    """
    return check_study(read_study(path), str(path))


def study_path() -> Path:
    """Return the path of config.yaml, in the checkout."""
    return Path(__file__).resolve().parents[3] / "config" / "config.yaml"
