"""The methods compared. A peer that cannot be imported is reported, not missed in silence."""

import importlib
from collections.abc import Callable

from benchmarks.methods.base import Method
from benchmarks.methods.vibralign import engines

# (module, class, arguments): a method each.
_PEERS = (
    ("heyoka_taylor", "HeyokaBatch", ()),
    ("heyoka_taylor", "HeyokaScalar", ()),
    ("numbalsoda_ivp", "NumbalsodaDop853", ()),
    ("cyrk", "Cyrk", ("DOP853",)),
    ("cyrk", "Cyrk", ("RK45",)),
    ("sundae", "Sundae", ("Adams",)),
    ("sundae", "Sundae", ("BDF",)),
    ("diffrax_vmap", "DiffraxVmap", ()),
    ("scipy_ivp", "ScipyIvp", ("RK45",)),
    ("scipy_ivp", "ScipyIvp", ("DOP853",)),
    ("scipy_ivp", "ScipyIvp", ("LSODA",)),
    ("scipy_ivp", "ScipyIvp", ("Radau",)),
    ("octave", "OctaveOde45", ()),
)


def all_methods(say: Callable[[str], None]) -> list[Method]:
    """The package's engines, then every peer that can be used here; ``say`` hears which cannot."""
    methods: list[Method] = list(engines())
    for module, name, arguments in _PEERS:
        try:
            peer = importlib.import_module(f"benchmarks.methods.{module}")
            methods.append(getattr(peer, name)(*arguments))
        except ImportError as error:
            say(f"{' '.join((name, *arguments))}: not installed ({error})")
    return methods
