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
    """Return the largest force at each place; dimensionless ones, or ``in_si`` those in N."""
    words = (
        f"{place} {si_words(each, FORCE) if in_si else in_words(each, FORCE, units)}"
        for place, each in forces.items()
    )
    return f"{', '.join(words)}, {until(settings)}"


def until(settings: Settings) -> str:
    """Return in words until when forces are known."""
    if settings.success is Outcome.INSERTED:
        return "until inserted"
    return "until alignment: --scene insertion for those in the hole"
