"""Devices measured in SI units, as a user writes them down: a YAML file of names and numbers."""

from collections.abc import Mapping
from pathlib import Path

import yaml

from model.physics.units import Device, device


class DeviceError(ValueError):
    """A file that describes no device."""


def load_device(path: Path, changes: Mapping[str, float]) -> Device:
    """The device in the YAML file ``path``, with ``changes`` over its quantities, in SI units.

    Raises:
        DeviceError: a file that cannot be read, is not YAML, or breaks a rule.
    """
    try:
        mapping = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        reason = " ".join(str(error).split())
        raise DeviceError(f"{path}: cannot be read as YAML: {reason}") from None
    if not isinstance(mapping, dict):
        raise DeviceError(f"{path}: must be lines of NAME: VALUE, one for each quantity")
    try:
        quantities = {str(name): _number(str(name), value) for name, value in mapping.items()}
        return device({**quantities, **changes})
    except ValueError as error:
        raise DeviceError(f"{path}: {error}") from None


def _number(name: str, value: object) -> float:
    """A number; YAML takes 5e-3, which has no point, for a text."""
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        try:
            return float(value)
        except ValueError:
            pass
    raise ValueError(f"{name} = {value!r}: must be a number, in SI units")
