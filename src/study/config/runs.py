"""Runs besides the figures: jamming in the slot."""

from pydantic import Field

from model.sweeps.axes import Axis, Family, Strict
from study.config.base import ParameterValues, Text


class Jamming(Strict):
    """Runs with the contacts inside the slot; see model/sweeps/sweep.py."""

    title: Text
    """Title of the figure."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters held at other values than the operating point's."""
    clearance: Family
    """Clearances, a panel each."""
    tilt_stiffness: Axis
    """Tilt stiffness; it varies the tilt at entry."""
    friction: Axis
    """Friction."""
