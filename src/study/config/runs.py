"""Runs besides the figures: those that only the claims need, and jamming in the slot."""

from pydantic import Field

from model.sweeps.axes import Axis, Family, Strict
from study.config.base import ParameterValues, Text


class ClaimRun(Strict):
    """Curves that only the claims ledger reads, at the operating point of a figure."""

    title: Text
    """Title of the run."""
    figure: str
    """Figure whose operating point the run takes."""
    held: ParameterValues = Field(default_factory=dict)
    """Parameters held at other values than the figure's."""
    centred: bool = False
    """Start with the mass centre above the edge, where the pressing force has no lever arm."""
    swept: Axis
    """Parameter along each curve."""
    family: Family
    """Parameter that differs between curves."""

    def changes(self, half_width: float, clearance: float) -> dict[str, float]:
        """Return the values that differ from the figure's, for a part of these sizes."""
        centred = {"misalignment": half_width * (1.0 + clearance)} if self.centred else {}
        return {**self.held, **centred}


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
