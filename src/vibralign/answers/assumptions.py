"""The assumptions of an answer, as commands, files and pages print them alike."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from model.events.outcomes import Outcome
from model.physics.parameters import Batch, Parameters
from model.physics.quantities import ANGLE, DAMPING, LENGTH, STIFFNESS, TIME
from model.physics.units import Units
from model.runs.settings import Settings
from model.sweeps.settings import Ensemble
from vibralign.answers.cases import tilts_of
from vibralign.answers.reliability import STATISTICAL_TOLERANCE
from vibralign.answers.si import in_words, named_words, si_words, written_words
from vibralign.device import StatedDevice
from vibralign.device.approach import SPEED
from vibralign.device.base import USUAL_STIFFNESS
from vibralign.device.mouth import GRIPPER_TILT

_STARTS = {
    "simultaneous": "press and vibration set in together, on a part that touches without load",
    "pressed": "the part rests under the press, then the vibration sets in",
    "running": "it is lowered while it vibrates; times count from the first touch",
    "still": "it is lowered, pressed and comes to rest, then the vibration sets in; times count "
    "from then on",
}


def assumptions(
    parameters: Parameters,
    settings: Settings,
    stated: StatedDevice | None = None,
    ensemble: Ensemble | None = None,
    *,
    tolerances_assumed: bool = False,
) -> dict[str, str]:
    """Return in words, by name, what the answer to a question on a device assumes.

    Args:
        parameters: dimensionless parameters of the device.
        settings: settings of its runs.
        stated: the device as its file states it, None for a dimensionless one.
        ensemble: the starts that are tried, None for the device's own.
        tolerances_assumed: True if the tolerances are assumed, not the file's.
    """
    units = None if stated is None else stated.units
    words = {
        "shape": _shape(settings, stated),
        "start": _start(settings, stated, ensemble),
        "touch-down": _touch_down(parameters, stated, ensemble),
        "goal": _goal(parameters, settings, stated),
        "base": _base(parameters, stated),
        "horizon": _horizon(settings, units),
        "precision": _precision(settings, counted=bool(ensemble and stated and stated.tolerances)),
    }
    printed = [name for name, each in vars(settings.readings).items() if each == "printed"]
    if printed:
        words["equations"] = f"as printed in the paper: {', '.join(printed)}"
    if stated is not None:
        words["tolerances"] = _tolerances(stated, assumed=tolerances_assumed)
        words["changed"] = changes_words(stated) or "nothing: all is as in the file"
    return words


def assumptions_with(
    device: StatedDevice,
    values: Mapping[str, float],
    settings: Settings,
    ensemble: Ensemble | None,
    *,
    tolerances_assumed: bool = False,
) -> dict[str, str]:
    """Return what the answer assumes for a device with other ``values`` of its quantities."""
    here = replace(device.changed(**values), changes=device.changes)
    own = here.run_settings(settings, here.units)
    return assumptions(here.parameters, own, here, ensemble, tolerances_assumed=tolerances_assumed)


def at_corners(corners: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Return what a map assumes, from the assumptions at its corners; lists those that vary."""
    words = {name: list(dict.fromkeys(each[name] for each in corners)) for name in corners[0]}
    varies = "varies over the map: "
    return {n: each[0] if len(each) == 1 else varies + "; ".join(each) for n, each in words.items()}


def lines_of(words: Mapping[str, str]) -> list[str]:
    """Return assumptions as lines of print."""
    width = max(map(len, words))
    return ["assumed:", *(f"  {name:<{width}}  {text}" for name, text in words.items())]


def as_attribute(words: Mapping[str, str]) -> str:
    """Return assumptions as the attribute of a dataset: JSON."""
    return json.dumps(words, ensure_ascii=False)


def changes_words(stated: StatedDevice) -> str:
    """Return what replaces the values of a device's file, such as "press_force=12 N"."""
    return ", ".join(
        f"{name}={value}"
        if isinstance(value, str)
        else named_words({name: float(str(value))}, stated)
        for name, value in stated.changes.items()
    )


def source_words(stated: StatedDevice) -> str:
    """Return the file of a device, and what replaces its values."""
    changes = changes_words(stated)
    return f"{stated.source}{changes and f', with {changes}'}"


def _shape(settings: Settings, stated: StatedDevice | None) -> str:
    if settings.shape == "round":
        unstated = stated is not None and stated.stated_shape is None
        return "round part in a round hole" + (" (not stated: assumed)" if unstated else "")
    return "square: a plane part beside a slot, as in the paper"


def _start(settings: Settings, stated: StatedDevice | None, ensemble: Ensemble | None) -> str:
    words = _STARTS[settings.start or "simultaneous"]
    if stated is None or stated.sudden:
        return words
    tried, known = stated.approaches(), {SPEED: SPEED in stated.quantities}
    missing = [name for name, is_known in (known | {"vibrator": bool(stated.vibrator)}).items()
               if not is_known]  # fmt: skip
    source = f"; not stated: {' and '.join(missing)}" if missing else ""
    if ensemble is not None and len(tried) > 1:
        return f"each of {'; '.join(map(str, tried))}{source}"
    return f"{tried[0]}: {words}{source}"


def _touch_down(
    parameters: Parameters, stated: StatedDevice | None, ensemble: Ensemble | None
) -> str:
    known = stated is None or GRIPPER_TILT in stated.quantities
    source = "" if known else " (gripper_tilt is not stated)"
    units = None if stated is None else stated.units
    if ensemble is None:
        tilt = in_words(parameters.initial_tilt, ANGLE, units)
        words = f"one start, at phase {parameters.phase:.4g} rad of the excitation"
        return f"{words}, tilted by {tilt}{source}; vibralign assess takes all phases"
    tilts = [parameters.initial_tilt * each for each in ensemble.tilts]
    tilts = tilts if stated is None else tilts_of(stated)
    words = " and ".join(in_words(each, ANGLE, units) for each in tilts)
    return f"at {ensemble.phases} phases of the excitation, tilted by {words}{source}"


def _goal(parameters: Parameters, settings: Settings, stated: StatedDevice | None) -> str:
    units = None if stated is None else stated.units
    if stated is not None and stated.is_chamfered:
        return "aligned: the face has reached the chamfers, whose flanks are not modelled"
    if settings.success is not Outcome.INSERTED:
        return "aligned: the edge is past the corner of the hole"
    reach, depth = float(Batch.stack([parameters]).reaches()[0]), settings.insertion_depth
    holds = f"{in_words(reach, LENGTH, units)}, where the press holds it against its axial spring"
    if depth is None:
        depth = depth_of(parameters, settings)
        why = f"half of {holds}" if 2.0 * depth >= reach else f"the half-width, of {holds}"
    else:
        why = f"of {holds}" if depth < reach else f"out of reach: it overshoots {holds}"
    return f"inserted to a depth of {in_words(depth, LENGTH, units)} ({why}; no further feed)"


def depth_of(parameters: Parameters, settings: Settings) -> float:
    """Return the depth at which a part is inserted, dimensionless."""
    own = settings.insertion_depth
    return float(Batch.stack([parameters]).insertion_depths()[0]) if own is None else own


def _base(parameters: Parameters, stated: StatedDevice | None) -> str:
    units = None if stated is None else stated.units
    stiffness = in_words(parameters.contact_stiffness, STIFFNESS, units)
    damping = in_words(parameters.contact_damping, DAMPING, units)
    if stated is None:
        return f"contact stiffness {stiffness}, damping {damping}"
    if stated.materials is not None:
        source = f"from {stated.materials} at this press force"
    elif stated.base_is_stated:
        source = "as stated"
    else:
        times = USUAL_STIFFNESS[stated.shape]
        source = f"not stated: {times:,.0f} times the axial stiffness"
    if math.isfinite(stated.fixture):
        source += f", in series with the fixture's {si_words(stated.fixture, STIFFNESS)}"
    impact = f"not stated: {parameters.contact_damping:.4g} in units of the model"
    if "restitution" in stated.quantities:
        impact = f"from a restitution of {stated.quantities['restitution']:g}"
    elif "contact_damping" in stated.quantities:
        impact = "as stated"
    return f"contact stiffness {stiffness} ({source}), damping {damping} ({impact})"


def _horizon(settings: Settings, units: Units | None) -> str:
    words = f"{settings.horizon:.4g} units of 1/p"
    if units is not None:
        words = f"{si_words(settings.horizon * units.time, TIME)} ({words})"
    if settings.success is Outcome.INSERTED:
        words += " until alignment, and as long again until insertion"
    return words


def _precision(settings: Settings, *, counted: bool) -> str:
    """Return the tolerance of runs, of ``counted`` devices as well, and what errors are of."""
    words = f"local error of a step {settings.tolerance:g}"
    if counted and settings.tolerance < STATISTICAL_TOLERANCE:
        words += f", {STATISTICAL_TOLERANCE:g} for devices within the tolerances"
    return f"{words}; estimated errors are of the numbers, not of the model"


def _tolerances(stated: StatedDevice, *, assumed: bool) -> str:
    if not stated.tolerances:
        return "none stated"
    rows = []
    for name, each in stated.tolerances.items():
        width = f"{100.0 * each.width:.4g} %"
        if not each.relative:
            width = written_words(name, each.width, stated)
        rows.append(f"{name} {each.sign} {width}")
    return ("none stated, so assumed: " if assumed else "as stated: ") + ", ".join(rows)
