"""Devices as an engineer states them: quantities with units, tolerances and a base."""

from model.study.devices.amounts import Tolerance
from model.study.devices.stated import DeviceError, StatedDevice, load_device

__all__ = ["DeviceError", "StatedDevice", "Tolerance", "load_device"]
