"""Read devices in SI units from YAML files of names and numbers."""

from collections.abc import Mapping
from pathlib import Path

import yaml

from model.physics.units import Device, device


class DeviceError(ValueError):
    """A file that describes no device."""


def load_device(path: Path, changes: Mapping[str, float]) -> Device:
    """Read the device in the YAML file ``path``; ``changes`` (SI units) replace its quantities.

    Raises:
        DeviceError: a file that cannot be read, is not YAML, or breaks a rule.
    """
    try:
        mapping = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, yaml.YAMLError) as error:
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
    """Convert to a number; YAML reads 5e-3, which has no point, as a string."""
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        try:
            return float(value)
        except ValueError:
            pass
    raise ValueError(f"{name} = {value!r}: must be a number, in SI units")
