"""Numbers and symbols as figures and the report print them."""

import pytest

from model.show.report.section import symbol
from model.show.words import mathtext, number, percent, power


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (3.2e-9, "3 × 10⁻⁹"),
        (1e-8, "10⁻⁸"),
        (44.0, "40"),
        (0.02, "0.02"),
        (0.0, "0"),
        (float("nan"), "–"),
    ],
)
def test_errors_are_written_with_one_digit(value, text):
    assert str(power(value)) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.25, "0.25"),
        (1e6, "1,000,000"),
        (2e-5, "0.00002"),
        (1.5e-9, "1.5 × 10⁻⁹"),
        (1e-10, "10⁻¹⁰"),
        (1234567.0, "1,234,570"),
    ],
)
def test_numbers_are_written_with_six_digits(value, text):
    assert number(value) == text


def test_shares_near_one_and_far_below_are_percentages():
    assert [percent(each) for each in (0.999, 1.0, 1e-8)] == ["100 %", "100 %", "0.000001 %"]


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
