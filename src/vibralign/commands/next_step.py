"""Command of a map to look at next where no change that was tried helps, ready to paste."""

import math
import shlex
from collections.abc import Mapping
from typing import TYPE_CHECKING

from vibralign.answers.si import written_words
from vibralign.commands.arguments import set_options
from vibralign.device.limits import OF_VIBRATOR, of_vibrator

if TYPE_CHECKING:
    from vibralign.device import StatedDevice

# Single changes and pairs are tried up to a factor of four: a larger amplitude is not.
_RANGES: Mapping[str, tuple[float, float]] = {"amplitude": (0.25, 12.0), "press_force": (0.25, 4.0)}


def ranges_to_look(stated: "StatedDevice") -> dict[str, tuple[float, float]]:
    """Return ranges in SI units over which to map a device, within the limits of its vibrator."""
    own = stated.quantities
    drive = of_vibrator(own["amplitude"], own["frequency"])
    most = min(stated.limits.get(name, math.inf) / drive[name] for name in OF_VIBRATOR)
    caps = {"amplitude": max(most, 1.0)}
    return {
        name: (own[name] * least, own[name] * min(largest, caps.get(name, math.inf)))
        for name, (least, largest) in _RANGES.items()
    }


def map_words(stated: "StatedDevice") -> str:
    """Return the command that maps a device over the quantities of ``ranges_to_look``."""
    words = [f"vibralign map --device {shlex.quote(str(stated.source))}"]
    changes = {
        name: value if isinstance(value, str) else written_words(name, float(str(value)), stated)
        for name, value in stated.changes.items()
    }
    words += set_options(changes).values()
    for side, (name, range_) in zip("xy", ranges_to_look(stated).items(), strict=True):
        ends = (written_words(name, each, stated) for each in range_)
        words.append(f"--{side} {name} {' '.join(map(shlex.quote, ends))}")
    words.append("--resolution 33 --out map.nc --plot map.png")
    return f"no change tried helps: look where it goes in with `{' '.join(words)}`"
