"""Numbers, units and ranges as engineers write them: read as meant, or refused with the remedy."""

import math

import pytest

from vibralign.device.amounts import read_amount, read_range

POUND, INCH = 4.4482216152605, 0.0254  # N and m, by definition


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("5e-3", "m", 5e-3),
        ("0.8 mm", "m", 0.8e-3),
        ("3 kN/m", "N/m", 3000.0),
        ("500 N mm/rad", "N m/rad", 0.5),
        ("0.5 N m", "N m/rad", 0.5),
        ("450 g cm²", "kg m²", 4.5e-5),
        ("2 deg", "rad", math.radians(2.0)),
        ("15 %", "1", 0.15),
        ("3000 rpm", "Hz", 50.0),
        ("100 rad/s", "Hz", 100.0 / (2.0 * math.pi)),
        ("0.05 kHz", "Hz", 50.0),
        ("6 Nm/rad", "N m/rad", 6.0),
        ("6 N-m", "N m/rad", 6.0),
        ("6 N·m/rad", "N m/rad", 6.0),
        ("4 Ns/m", "N s/m", 4.0),
        ("4 mNms/rad", "N m s/rad", 4e-3),
        ("1.2e-4 kgm²", "kg m²", 1.2e-4),
        ("1200 g cm2", "kg m²", 1.2e-4),
        ("100 lb/in", "N/m", 100.0 * POUND / INCH),
        ("5 lbf", "N", 5.0 * POUND),
        ("10 in-lb/rad", "N m/rad", 10.0 * POUND * INCH),
        ("30 mil", "m", 30e-3 * INCH),
        ("60 hz", "Hz", 60.0),
        ("0.06 KHZ", "Hz", 60.0),
        ("3600 min-1", "Hz", 60.0),
        ("3600 RPM", "Hz", 60.0),
        ("3600 rev/min", "Hz", 60.0),
        ("60 rev/s", "Hz", 60.0),
        ("130 grain", "kg", 130.0 * 0.45359237 / 7000.0),
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


@pytest.mark.parametrize(
    ("text", "unit", "value", "kind", "relative", "around"),
    [
        ("10 N ± 0.5 N", "N", 10.0, "uniform", False, 0.5),
        ("10 ± 0.5 N", "N", 10.0, "uniform", False, 0.5),
        ("10 N +- 500 mN", "N", 10.0, "uniform", False, 0.5),
        ("0.01 kN ± 5 %", "N", 10.0, "uniform", True, 0.5),
        ("10 N σ 0.2 N", "N", 10.0, "normal", False, 0.2),
        ("10 sigma 2 %", "N", 10.0, "normal", True, 0.2),
        ("4 % ± 1 %", "1", 0.04, "uniform", False, 0.01),  # in its own per cent
        ("(12 ± 3) %", "1", 0.12, "uniform", False, 0.03),
        ("0.15 ± 10 %", "1", 0.15, "uniform", True, 0.015),  # a width of 0.1 would reach below 0
    ],
)
def test_a_tolerance_is_a_width_or_a_share(text, unit, value, kind, relative, around):
    amount = read_amount("it", text, unit)
    assert amount.value == pytest.approx(value)
    assert (amount.tolerance.kind, amount.tolerance.relative) == (kind, relative)
    assert amount.tolerance.around(value) == pytest.approx(around)
    assert read_amount("it", "10 ± 0", unit).tolerance is None


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("0.05 mm", "1", "must be a ratio"),
        ("25 %", "rad", "% is no unit of it"),
        ("8 N m/%", "N m/rad", "N m/% is no unit of it"),
        ("8 Nm/grad", "N m/rad", "grad is degree or gon: write 8 Nm/deg or 8 Nm/gon"),
        ("0.1 to 0.25", "1", "state one value, or 0.175 ± 0.075 if it varies"),
        ("0.05 mm / 6 mm", "1", "unknown unit"),
        ("1/0", "1", "unknown unit '/0'"),
        ("3 N**", "N", "unknown unit"),
        ("12,1 N", "N", "write a decimal point"),
        ("12 1 N", "N", "write a decimal point"),
        ("ten", "N", "must be a number in N, or with a unit"),
        (True, "N", "must be a number in N"),
        ("3 N ±", "N", "a number must stand before and after ±"),
        ("3 N ± -1 N", "N", "the tolerance must be >= 0"),
        ("15,000 mN", "N", "write a decimal point"),
        ("15 000 mN", "N", "write a decimal point"),
        ("12 ± 3 %", "1", "Write 12 % ± 3 %, or 12 ± 0.36"),
        ("20-150 Hz", "Hz", "is a range; state one value"),
        ("20 mm +0.1/-0.2", "m", "a tolerance is symmetric: write the middle"),
        ("5 MM", "m", "must be in m or alike, not in MM"),
        (None, "N", "it is not filled in: must be a number in N"),
        ("130 gr", "kg", "gr is gram or grain: write 130 g or 130 grain"),
        ("450 gr cm²", "kg m²", "write 450 g cm² or 450 grain cm²"),
        ("5 mm p-p", "m", "unknown unit"),  # an amplitude only is from peak to peak
    ],
)
def test_what_may_mean_two_things_is_refused_with_the_remedy(text, unit, words):
    with pytest.raises(ValueError, match=r"^it (= |is not filled in)") as refusal:
        read_amount("it", text, unit)
    assert words in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "unit", "ends"),
    [
        ("2 to 30 N", "N", (2.0, 30.0)),
        ("2 N to 0.03 kN", "N", (2.0, 30.0)),
        ("200 to 300 mm", "m", (0.2, 0.3)),
        ("20 to 150 Hz", "Hz", (20.0, 150.0)),
        ("20–150 Hz", "Hz", (20.0, 150.0)),
        ("20-150 Hz", "Hz", (20.0, 150.0)),
        ("20 Hz - 0.15 kHz", "Hz", (20.0, 150.0)),
        ("20...150 Hz", "Hz", (20.0, 150.0)),
        ("-5..5 mm", "m", (-5e-3, 5e-3)),
        ("-5-5 mm", "m", (-5e-3, 5e-3)),
        ("1e-3-5e-3 N", "N", (1e-3, 5e-3)),
    ],
)
def test_a_range_is_written_with_a_word_dashes_or_dots(text, unit, ends):
    assert read_range("it", text, unit) == pytest.approx(ends)


FREQUENCY = 60.0  # Hz
RATE = 2.0 * math.pi * FREQUENCY  # a vibration A sin(ωt) has the velocity Aω, the acceleration Aω²


@pytest.mark.parametrize(
    ("text", "peak"),
    [
        ("0.8 mm", 0.8e-3),
        ("0.8 mm peak", 0.8e-3),
        ("0.8 mm 0-p", 0.8e-3),
        ("0.8 mm p-p", 0.4e-3),
        ("0.8 mm pk-pk", 0.4e-3),
        ("0.8 mm Peak-to-Peak", 0.4e-3),
        ("800 µmpp", 0.4e-3),
        ("0.8 mm rms", 0.8e-3 * math.sqrt(2.0)),
        ("5 g", 5.0 * 9.80665 / RATE**2),
        ("5 Grms", 5.0 * 9.80665 * math.sqrt(2.0) / RATE**2),
        ("49 m/s²", 49.0 / RATE**2),
        ("50 mm/s rms", 0.05 * math.sqrt(2.0) / RATE),
    ],
)
def test_an_amplitude_is_the_peak_of_what_is_stated(text, peak):
    assert read_amount("amplitude", text, "m", FREQUENCY).value == pytest.approx(peak, rel=1e-12)
    absolute = read_amount("amplitude", f"{text} ± 0.1", "m", FREQUENCY).tolerance
    relative = read_amount("amplitude", f"{text} ± 10 %", "m", FREQUENCY)
    assert relative.tolerance.around(relative.value) == pytest.approx(0.1 * peak)
    number = float(text.partition(" ")[0])
    assert absolute.width == pytest.approx(0.1 / number * peak)


def test_a_range_of_amplitudes_is_one_of_peaks():
    assert read_range("amplitude", "0.2 to 1 mm p-p", "m") == pytest.approx((1e-4, 5e-4))
    per_g = 9.80665 / RATE**2
    assert read_range("amplitude", "1..5 g", "m", FREQUENCY) == pytest.approx((per_g, 5.0 * per_g))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,8 mm p-p", "write a decimal point"),
        ("0.8 mm p-p ± 0.1 mm rms", "two of peak, peak-to-peak and rms: write one"),
        ("5 g", "is an acceleration, which gives an amplitude at one frequency only.*write .* mm"),
        ("5 kg", "must be in m or alike, not in kg"),
    ],
)
def test_an_amplitude_that_is_not_one_peak_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        read_amount("amplitude", text, "m", None)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("3 N", "must"),
        ("5 to 2 N", "must"),
        (3.0, "must"),
        ("20 to 1,500 N", "write a decimal point"),
    ],
)
def test_what_is_no_range_is_refused(text, words):
    with pytest.raises(ValueError, match=words):
        read_range("it", text, "N")
