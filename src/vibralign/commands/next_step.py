"""What to try next where no change that was tried helps: a command, ready to paste."""

import shlex
from collections.abc import Mapping
from typing import TYPE_CHECKING

from vibralign.answers.si import written_words
from vibralign.commands.arguments import set_options

if TYPE_CHECKING:
    from vibralign.device import StatedDevice

# Single changes and pairs are tried up to a factor of four: a larger amplitude is not.
_RANGES: Mapping[str, tuple[float, float]] = {"amplitude": (0.25, 12.0), "press_force": (0.25, 4.0)}


def map_words(stated: "StatedDevice") -> str:
    """Return the command that maps a device over the two quantities of ``_RANGES``."""
    words = [f"vibralign map --device {shlex.quote(str(stated.source))}"]
    changes = {
        name: value if isinstance(value, str) else written_words(name, float(str(value)), stated)
        for name, value in stated.changes.items()
    }
    words += set_options(changes).values()
    for side, (name, factors) in zip("xy", _RANGES.items(), strict=True):
        ends = (written_words(name, stated.quantities[name] * each, stated) for each in factors)
        words.append(f"--{side} {name} {' '.join(map(shlex.quote, ends))}")
    words.append("--resolution 33 --out map.nc --plot map.png")
    return f"no change tried helps: look where it goes in with `{' '.join(words)}`"
