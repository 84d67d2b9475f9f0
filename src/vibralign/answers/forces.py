"""Largest contact forces by place, and until when they are known, in words."""

from collections.abc import Mapping

from model.events.outcomes import Outcome
from model.physics.quantities import FORCE
from model.physics.units import Units
from model.runs.settings import Settings
from vibralign.answers.si import in_words, si_words


def forces_words(
    forces: Mapping[str, float], units: Units | None, settings: Settings, *, in_si: bool = False
) -> str:
    """Return the largest force at each place; dimensionless ones, or ``in_si`` those in N.

    The edge is a round part's two tips together; the force at each of them stands beside.
    """

    def words(force: float) -> str:
        return si_words(force, FORCE) if in_si else in_words(force, FORCE, units)

    places = {place: f"{place} {words(each)}" for place, each in forces.items()}
    if settings.shape == "round":
        places["edge"] += f" ({words(tip_force(forces['edge']))} at each tip)"
    return f"{', '.join(places.values())}, {until(settings)}"


def tip_force(edge_force: float) -> float:
    """Return the largest force at one of two tips, which carry a round part's edge force."""
    return 0.5 * edge_force


def tip_record(edge_force: float, settings: Settings) -> dict[str, float]:
    """Return the largest force at one tip of a round part, for --json; empty for a square one."""
    return {"tip_force_max": tip_force(edge_force)} if settings.shape == "round" else {}


def until(settings: Settings) -> str:
    """Return in words until when forces are known."""
    if settings.success is Outcome.INSERTED:
        return "until inserted"
    return "until alignment"
