"""Numbers, symbols and names as figures and the report print them."""

import math
from decimal import Decimal


def short(value: float, digits: int = 2) -> str:
    """Return a number rounded to ``digits`` significant digits, without an exponent."""
    return f"{Decimal(f'{value:.{digits}g}'):,f}"


def number(value: float) -> str:
    """Return a number with six significant digits at most, such as 0.05, 2,000 or 1.5 × 10⁻⁹."""
    return _in_powers(value, 6) if _far_from_one(value, 6) else short(value, 6)


def percent(share: float) -> str:
    """Return a share as a percentage with two digits, a dash for NaN."""
    return "–" if math.isnan(share) else f"{short(100.0 * share)} %"


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power(value: float) -> str:
    """Return an error with one digit, such as 0.02, 40 or 3 × 10⁻⁹; a dash for NaN."""
    if math.isnan(value):
        return "–"
    return _in_powers(value, 1) if _far_from_one(value, 3) else short(value, 1)


def _far_from_one(value: float, decades: int) -> bool:
    return value != 0.0 and abs(int(f"{value:.0e}".partition("e")[2])) > decades


def _in_powers(value: float, digits: int) -> str:
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    factor = "" if float(mantissa) == 1.0 else f"{float(mantissa):g} × "
    return f"{factor}10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


def symbol_parts(symbol: str) -> tuple[str, str]:
    """Split a symbol of ``parameters.FIELDS`` into its letter and its subscript, if it has one."""
    head, rest = symbol[0], symbol[1:]
    return (head, rest.lstrip("_")) if rest.startswith("_") or rest.isdigit() else (symbol, "")


def mathtext(symbol: str) -> str:
    """Return a symbol of ``parameters.FIELDS`` as matplotlib's mathematical text."""
    head, index = symbol_parts(symbol)
    if not index:
        return f"${head}$"
    return f"${head}_{{\\mathrm{{{index}}}}}$" if len(index) > 1 else f"${head}_{{{index}}}$"


def figure_number(name: str) -> int:
    """Return 6 for "fig06"."""
    return int(name.removeprefix("fig"))


def figure_title(name: str) -> str:
    """Return "Fig. 6" for "fig06"."""
    return f"Fig. {figure_number(name)}"
