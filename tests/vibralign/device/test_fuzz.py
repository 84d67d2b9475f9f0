"""Device files as people write them, by the thousand: read as meant, or refused in a line."""

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vibralign.device import DeviceError, load_device

# A device in SI units; each is written in some unit of its size, with a tolerance, or spoilt.
OWN = {
    "mass": 0.25, "axial_stiffness": 15e3, "lateral_stiffness": 3e3, "tilt_stiffness": 6.0,
    "axial_damping_ratio": 0.07, "lateral_damping_ratio": 0.07, "tilt_damping_ratio": 0.07,
    "amplitude": 0.8e-3, "frequency": 60.0, "press_force": 15.0, "diameter": 8e-3,
    "length": 30e-3, "inertia": 1.2e-4, "friction": 0.12, "play": 40e-6, "misalignment": 0.15e-3,
    "gripper_tilt": 2e-3,
}  # fmt: skip
POUND, INCH, DEGREE = 0.45359237, 0.0254, math.pi / 180.0
UNITS = {
    "mass": {"": 1.0, "kg": 1.0, "g": 1e-3, "Kg": 1.0, "lb": POUND},
    "axial_stiffness": {"": 1.0, "N/m": 1.0, "kN/m": 1e3, "N/mm": 1e3, "N mm-1": 1e3},
    "lateral_stiffness": {"": 1.0, "kN/m": 1e3, "lbf/in": 9.80665 * POUND / INCH},
    "tilt_stiffness": {"": 1.0, "Nm/rad": 1.0, "N-m": 1.0, "Nmm/deg": 0.18 / math.pi},
    **{f"{each}_damping_ratio": {"": 1.0, "%": 0.01} for each in ("axial", "lateral", "tilt")},
    "amplitude": {"": 1.0, "mm": 1e-3, "µm": 1e-6, "mm p-p": 0.5e-3, "mm rms": math.sqrt(2e-6)},
    "frequency": {"": 1.0, "Hz": 1.0, "hz": 1.0, "rpm": 1.0 / 60.0, "rad/s": 0.5 / math.pi},
    "press_force": {"": 1.0, "N": 1.0, "kN": 1e3, "lb": 9.80665 * POUND},
    "diameter": {"": 1.0, "mm": 1e-3, "in": INCH, "mil": 1e-3 * INCH},
    "length": {"": 1.0, "cm": 1e-2, "mm": 1e-3},
    "inertia": {"": 1.0, "kg m²": 1.0, "kgmm²": 1e-6, "g cm2": 1e-7},
    "friction": {"": 1.0, "%": 0.01},
    "play": {"": 1.0, "mm": 1e-3, "um": 1e-6},
    "misalignment": {"": 1.0, "mm": 1e-3, "μm": 1e-6},
    "gripper_tilt": {"": 1.0, "rad": 1.0, "mrad": 1e-3, "deg": DEGREE, "°": DEGREE},
}  # fmt: skip
SPOILT = (
    "", "~", "[1, 2]", "{a: 1}", "&a [*a]", "true", "soon", "0,5", "1 000", "5 foo", "nan", "inf",
    "-.inf", "1e999", "5 %%", "± 5 %", "1 to 2", "1 ± 2 ± 3", "0x10", "!!python/name:os.system",
    "'\\u0000'", "1 grad", "1 gr", "5 N m", "3 mm/s/s/s", "1:30", "|\n  1\n  2", "<!--", "\t1",
    "1 ± nan", "-0", "1 +0.1/-0.2", "(1 ± 0.1) (2)", "⅓", "1²", "1e5000 mm", "5 N;rm -rf",
)  # fmt: skip
BESIDES = (
    "materials: steel on steel\nedge_radius: 0.1 mm", "materials: [steel]", "fit: [H7]",
    "free: {press_force: 5 to 20 N}", "free: [1]", "free: {press_force: 5}", "limits: {time: 1 s}",
    "limits: {time: 1 s ± 0.1 s}", "limits: {vibration: [needed]}", "limits: 5", "limits: {a: 1}",
    "start: [pressed]", "shape: {round: 1}", "shape: oval", "restitution: 0.5", "a: &a [*a]",
    "? [1, 2]\n: 3", "1: 2", "mass: 1", "limits: {acceleration: 50 g, stroke: 4 mm}",
    "fixture_stiffness: 50 N/mm", "clearance: 0.01", "half_width: 4 mm", "centre_height: 20 mm",
)  # fmt: skip


@st.composite
def files(draw):
    """The text of a file in some encoding, and the values that it means; None if it is spoilt."""
    meant, lines = dict[str, float](), []
    spoilt = draw(st.none() | st.sampled_from(sorted(OWN)))
    for name, value in OWN.items():
        if name == spoilt:
            lines.append(f"{name}: {draw(st.sampled_from(SPOILT) | st.text(max_size=12))}")
            continue
        unit = draw(st.sampled_from(sorted(UNITS[name])))
        written = f"{value / UNITS[name][unit]:.{draw(st.integers(4, 12))}g}"
        meant[name] = float(written) * UNITS[name][unit]
        spread = draw(st.sampled_from(("", "", "", " ± 1 %", " +- 2%", " σ 1 %")))
        minus = draw(st.sampled_from((" ", "\u00a0", "")))
        lines.append(f"{name}: {written}{minus if unit else ''}{unit}{spread}")
    besides = draw(st.lists(st.sampled_from(BESIDES), max_size=1))
    encoding = draw(st.sampled_from(("utf-8", "utf-8-sig", "utf-16", "latin-1")))
    text = draw(st.sampled_from(("\n", "\r\n"))).join([*draw(st.permutations(lines)), *besides, ""])
    return text.encode(encoding, "ignore"), meant, spoilt, besides


@pytest.mark.nightly
@settings(
    max_examples=2000, deadline=None, derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)  # fmt: skip
@given(file=files())
def test_a_file_is_read_as_it_is_meant_or_refused_in_one_line(file, tmp_path):
    content, meant, spoilt, besides = file
    path = tmp_path / "peg.yaml"
    path.write_bytes(content)
    stated, words = None, ""
    try:
        stated = load_device(path)
    except DeviceError as refusal:
        words = str(refusal)
    if stated is None:
        assert words.startswith(f"{path}: ")
        assert "\n" not in words
        assert spoilt or besides or "UTF-8" in words or "unknown unit" in words
        return
    for name, value in meant.items():
        if name in stated.quantities:
            assert stated.quantities[name] == pytest.approx(value, rel=1e-12), name
    assert isinstance(stated.doubts, list)
