"""Devices as an engineer states them: quantities with units, tolerances and a base."""

from vibralign.device.amounts import Tolerance
from vibralign.device.load import load_device
from vibralign.device.plausibility import DeviceError
from vibralign.device.stated import StatedDevice

__all__ = ["DeviceError", "StatedDevice", "Tolerance", "load_device"]
