"""The lever of the press at the start, and the misalignments from which it tilts the part."""

import math

from model.physics.geometry import farthest_tilted, lever_doubt, press_lever
from model.physics.parameters import Parameters, Shape, constants_of
from model.physics.quantities import ANGLE, LENGTH
from model.physics.units import Units
from model.runs.settings import Settings
from vibralign.answers.si import in_words, rounded, scale

_PLACES: dict[Shape, str] = {"square": "the far edge", "round": "the tips of the crescent"}
_STANDS = 0.01  # doubt of the lever that is worth a line


def lever_words(parameters: Parameters, settings: Settings, units: Units | None) -> list[str]:
    """Return lines on the lever of a part of the settings' shape."""
    shape: Shape = settings.shape or "square"
    p = constants_of(parameters, shape)
    lever = in_words(press_lever(p), LENGTH, units)
    lines = [f"{'lever':<16}{lever} about {_PLACES[shape]}"]
    if shape == "round":
        down = _down(parameters, units)
        farthest = in_words(farthest_tilted(p) + down, LENGTH, units)
        stated = in_words(parameters.misalignment + down, LENGTH, units)
        words = f"from misalignments below {farthest} (stated {stated}); beyond, it stands flat"
        lines.append(f"{'tilts':<16}{words}")
        doubt = lever_doubt(p)
        if _STANDS < doubt < math.inf:
            words = f"if the rims yield, the lever is up to {rounded(100.0 * doubt, 2)} % longer"
            lines.append(f"{'soft base':<16}{words}")
    return lines


def _down(parameters: Parameters, units: Units | None) -> float:
    """Return by how much a misalignment is larger than x(0): a device in SI has it at the mouth."""
    return parameters.half_height * math.sin(parameters.initial_tilt) if units else 0.0


def wall_words(
    parameters: Parameters, settings: Settings, tilt: float, units: Units | None
) -> list[str]:
    """Return a line if a round part tilts beyond the contact with the wall that is modelled."""
    steepest = math.acos(1.0 / (1.0 + parameters.clearance))
    if settings.shape != "round" or tilt <= steepest:
        return []
    limit = in_words(steepest, ANGLE, units)
    words = f"beyond a tilt of {limit} a round rim meets the wall at two points, modelled as one"
    return [f"{'not modelled':<16}{words}"]


def lever_record(
    parameters: Parameters, settings: Settings, units: Units | None
) -> dict[str, float | str]:
    """Return shape, lever and farthest misalignment for --json, in SI units with ``units``."""
    shape: Shape = settings.shape or "square"
    p, one = constants_of(parameters, shape), scale(units, LENGTH)
    return {
        "shape": shape,
        "lever": press_lever(p) * one,
        "farthest_tilted": (farthest_tilted(p) + _down(parameters, units)) * one,
        "lever_doubt": lever_doubt(p) if shape == "round" else 0.0,
    }
