"""Numbers, units and ranges as engineers write them: read as meant, or refused with the remedy."""

import math

import pytest

from model.study.devices.amounts import read_amount, read_range

POUND, INCH = 4.4482216152605, 0.0254  # N and m, by definition


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("6 Nm/rad", "N m/rad", 6.0),
        ("6 N-m", "N m/rad", 6.0),
        ("6 N·m/rad", "N m/rad", 6.0),
        ("6000 Nmm/rad", "N m/rad", 6.0),
        ("4 Ns/m", "N s/m", 4.0),
        ("4 mNms/rad", "N m s/rad", 4e-3),
        ("1.2e-4 kgm²", "kg m²", 1.2e-4),
        ("1200 g cm2", "kg m²", 1.2e-4),
        ("120 kgmm^2", "kg m²", 1.2e-4),
        ("100 lb/in", "N/m", 100.0 * POUND / INCH),
        ("5 lbf", "N", 5.0 * POUND),
        ("5 lb", "kg", 0.45359237 * 5.0),
        ("10 in-lb/rad", "N m/rad", 10.0 * POUND * INCH),
        ("30 mil", "m", 30e-3 * INCH),
        ("60 hz", "Hz", 60.0),
        ("0.06 KHZ", "Hz", 60.0),
        ("3600 min-1", "Hz", 60.0),
        ("3600 RPM", "Hz", 60.0),
        ("0.25 Kg", "kg", 0.25),
        ("5 Newton", "N", 5.0),
        ("−5 mm", "m", -5e-3),
        ("5\u00a0mm", "m", 5e-3),
        ("15°", "rad", math.radians(15.0)),
        ("050", "Hz", 50.0),
    ],
)
def test_a_spelling_is_read_as_it_is_meant(text, unit, value):
    assert read_amount("it", text, unit).value == pytest.approx(value, rel=1e-12)


def test_a_unit_behind_brackets_is_that_of_both():
    amount = read_amount("it", "(12 ± 3) %", "1")
    assert (amount.value, amount.tolerance.width) == pytest.approx((0.12, 0.03))
    assert not amount.tolerance.relative


def test_a_tolerance_of_a_ratio_in_per_cent_is_a_share_where_it_can_mean_nothing_else():
    amount = read_amount("friction", "0.15 ± 10 %", "1")
    assert (amount.value, amount.tolerance.around(0.15)) == pytest.approx((0.15, 0.015))


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("15,000 mN", "N", "write 15000 mN if the comma groups thousands, 15.000 mN if it is dec"),
        ("1,500,000 mN", "N", "write 1500000 mN"),
        ("15 000 mN", "N", "write 15000 mN"),
        ("15'000 mN", "N", "write 15000 mN"),
        ("1,234.5 N", "N", "write 1234.5 N"),
        ("1.234,5 N", "N", "write 1234.5 N"),
        ("0,125 N", "N", "write 0.125 N"),
        ("12 ± 3 %", "1", "Write 12 % ± 3 %, or 12 ± 0.36"),
        ("20–150 Hz", "Hz", "is a range; state one value"),
        ("20-150 Hz", "Hz", "is a range; state one value"),
        ("20 mm +0.1/-0.2", "m", "a tolerance is symmetric: write the middle"),
        ("5 Nm", "N", "must be in N or alike, not in Nm"),
        ("5 MM", "m", "must be in m or alike, not in MM"),
        (None, "N", "it is not filled in: must be a number in N"),
    ],
)
def test_what_may_mean_two_things_is_refused_with_the_remedy(text, unit, words):
    with pytest.raises(ValueError, match=r"^it ") as refusal:
        read_amount("it", text, unit)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    "text", ["20 to 150 Hz", "20–150 Hz", "20-150 Hz", "20 Hz - 0.15 kHz", "20…150", "20...150 Hz"]
)
def test_a_range_is_written_with_a_word_dashes_or_dots(text):
    assert read_range("it", text, "Hz") == pytest.approx((20.0, 150.0))


def test_the_ends_of_a_range_may_be_negative_or_have_an_exponent():
    assert read_range("it", "−5 to 5 mm", "m") == pytest.approx((-5e-3, 5e-3))
    assert read_range("it", "1e-3-5e-3 N", "N") == (1e-3, 5e-3)
    with pytest.raises(ValueError, match="write 1500 Hz if the comma groups thousands"):
        read_range("it", "20 to 1,500 Hz", "Hz")
