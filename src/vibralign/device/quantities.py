"""Names of the quantities of a device file, with meaning, unit, symbol and admissible range."""

import difflib

from model.physics.fields import Bound
from model.physics.parameters import FIELDS
from model.physics.quantities import Quantity
from model.physics.units import UNITS
from vibralign.device.base import BASE
from vibralign.device.instead import INSTEAD
from vibralign.device.mouth import MOUTH, REPLACED, check_not_replaced

_OWN = {**{n: each for n, each in FIELDS.items() if n not in REPLACED}, **UNITS, **MOUTH}
QUANTITIES = (*UNITS, *(n for n in _OWN if n not in UNITS), *INSTEAD, *BASE)

_WHOLE = {  # what is close to the name of its half
    "width": "Write diameter, of a square part its width; half_width is half of it",
    "height": "Write length, of the whole part; half_height is half of it",
}


def unit_of(name: str) -> str:
    """Return the SI unit of a quantity of a device, "1" if it has none.

    Raises:
        ValueError: an unknown quantity.
    """
    return quantity_of(name)[1].unit


def quantity_of(name: str) -> tuple[str, Quantity, str]:
    """Return meaning, physical quantity and symbol of a quantity of a device; "" without a symbol.

    Raises:
        ValueError: an unknown quantity.
    """
    check_quantity(name)
    if name in _OWN:
        return _OWN[name].description, _OWN[name].quantity, _OWN[name].symbol
    if name in INSTEAD:
        each = INSTEAD[name]
        return f"{each.description}, in place of {each.parameter}", each.quantity, ""
    return *BASE[name], ""


def bound_of(name: str) -> Bound:
    """Return the admissible range of a quantity of a device."""
    return (_OWN | INSTEAD)[name].bound if name not in BASE else "> 0"  # type: ignore[operator]


def check_quantity(name: str) -> None:
    """Refuse a name that is no quantity of a device; of an old one, say what to write instead."""
    check_not_replaced(name)
    if name not in QUANTITIES:
        near = difflib.get_close_matches(name, QUANTITIES, n=1)
        hint = f"Did you mean {near[0]!r}? " if near else ""
        hint = f"{_WHOLE[name]}. " if name in _WHOLE else hint
        raise ValueError(
            f"unknown quantity of a device {name!r}. {hint}`vibralign new FILE` writes a file with "
            "those that a device has, `vibralign simulate --help` lists all"
        )
