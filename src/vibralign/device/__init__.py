"""Devices as an engineer states them: quantities with units, tolerances and a base."""

from vibralign.device.amounts import Tolerance
from vibralign.device.plausibility import DeviceError
from vibralign.device.stated import StatedDevice, load_device

__all__ = ["DeviceError", "StatedDevice", "Tolerance", "load_device"]
