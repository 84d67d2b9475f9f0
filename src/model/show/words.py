"""Numbers, symbols and names as figures and the report print them."""

import math as _math


def number(value: float) -> str:
    """Return a number with six significant digits at most."""
    return f"{value:.6g}"


def short(value: float, digits: int = 2) -> str:
    """Return a number rounded to ``digits`` significant digits, without an exponent."""
    return f"{float(f'{value:.{digits}g}'):,.15g}"


def percent(share: float) -> str:
    """Return a share as a percentage with two digits, a dash for NaN."""
    return "–" if _math.isnan(share) else f"{short(100.0 * share)} %"


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power(value: float) -> str:
    """Return an error with one digit, such as 0.02, 40 or 3 × 10⁻⁹; a dash for NaN."""
    if _math.isnan(value):
        return "–"
    mantissa, exponent = f"{value:.0e}".split("e")
    if value == 0.0 or -3 <= int(exponent) <= 3:
        return short(value, 1)
    digit = "" if mantissa == "1" else f"{mantissa} × "
    return f"{digit}10{str(int(exponent)).translate(_SUPERSCRIPTS)}"


def symbol_parts(symbol: str) -> tuple[str, str]:
    """Split a symbol of ``parameters.FIELDS`` into its letter and its subscript, if it has one."""
    head, rest = symbol[0], symbol[1:]
    return (head, rest.lstrip("_")) if rest.startswith("_") or rest.isdigit() else (symbol, "")


def math(symbol: str) -> str:
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
