"""Numbers and symbols as figures and the report print them."""

import pytest

from study.report.section import symbol
from vibralign.plots.words import mathtext, number, percent, power


@pytest.mark.parametrize(
    ("write", "value", "text"),
    [
        (power, 3.2e-9, "3 × 10⁻⁹"),  # errors have one digit
        (power, 1e-8, "10⁻⁸"),
        (power, 44.0, "40"),
        (power, 0.02, "0.02"),
        (power, 0.0, "0"),
        (power, float("nan"), "–"),
        (number, 0.25, "0.25"),
        (number, 1e6, "1,000,000"),
        (number, 2e-5, "0.00002"),
        (number, 1.5e-9, "1.5 × 10⁻⁹"),
        (number, 1e-10, "10⁻¹⁰"),
        (number, 1234567.0, "1,234,570"),  # six digits
        (percent, 0.999, "100 %"),
        (percent, 1.0, "100 %"),
        (percent, 1e-8, "0.000001 %"),
    ],
)
def test_errors_numbers_and_shares_are_written_short(write, value, text):
    assert str(write(value)) == text


@pytest.mark.parametrize(
    ("text", "in_html", "in_figures"),
    [
        ("f0", "<i>f</i><sub>0</sub>", "$f_{0}$"),
        ("k_φ", "<i>k</i><sub>φ</sub>", "$k_{φ}$"),
        ("x_st", "<i>x</i><sub>st</sub>", r"$x_{\mathrm{st}}$"),
        ("x(0)", "<i>x(0)</i>", "$x(0)$"),
    ],
)
def test_symbols_are_set_as_in_the_paper(text, in_html, in_figures):
    assert (str(symbol(text)), mathtext(text)) == (in_html, in_figures)
