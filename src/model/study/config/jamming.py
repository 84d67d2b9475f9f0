"""Jamming in the slot over friction, clearance and tilt at entry."""

from pydantic import Field

from model.study.config.base import Axis, Family, ParameterValues, Strict, Text


class Jamming(Strict):
    """Runs with the contacts inside the slot; see model/study/sweep.py."""

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
