"""The methods of ``make bench``; a peer that cannot be imported is reported."""

import importlib
from collections.abc import Callable

from verification.bench.methods.base import Method
from verification.bench.methods.package import OneRun, Package

# (module, class, arguments) of methods that no other beats on all problems; and RK45, because it is
# scipy's default (decision 8).
_PEERS = (
    ("heyoka_batch", "HeyokaBatch", ()),
    ("scipy_ivp", "ScipyIvp", ("RK45",)),
    ("scipy_ivp", "ScipyIvp", ("DOP853",)),
    ("scipy_ivp", "ScipyIvp", ("LSODA",)),
)


def all_methods(say: Callable[[str], None]) -> list[Method]:
    """Return the package, then the installed peers; report the others by ``say``.

    Ratios refer to the first method.
    """
    methods: list[Method] = [
        Package("vibralign"),
        OneRun("vibralign, one run"),
    ]
    for module, name, arguments in _PEERS:
        try:
            peer = importlib.import_module(f"verification.bench.methods.{module}")
            methods.append(getattr(peer, name)(*arguments))
        except ImportError as error:
            say(f"{' '.join((name, *arguments))}: not installed ({error})")
    return methods
