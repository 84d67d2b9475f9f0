"""vibralign new: a device file to fill in."""

import re
from pathlib import Path

import pytest

from vibralign.commands import main as cli
from vibralign.device import load_device
from vibralign.device.limits import LIMITS
from vibralign.device.quantities import QUANTITIES

DOCS = Path(__file__).resolve().parents[3] / "docs"
TUTORIAL = (DOCS / "tutorial.md").read_text(encoding="utf-8")
FILLED = {
    "mass": "0.25 kg", "axial_frequency": "39 Hz", "lateral_frequency": "17 Hz",
    "tilt_frequency": "36 Hz", "axial_damping_ratio": "7 %", "lateral_damping_ratio": "7 %",
    "tilt_damping_ratio": "7 %", "amplitude": "0.8 mm", "frequency": "60", "press_force": "15 N",
    "diameter": "8 mm", "length": "30 mm", "inertia": "120 kgmm²", "friction": "0.12",
    "play": "0.04 mm", "misalignment": "0.15 mm",
}  # fmt: skip


def test_the_new_file_names_every_quantity_and_runs_once_it_is_filled_in(tmp_path, capsys):
    path = tmp_path / "peg.yaml"
    assert cli.main(["new", str(path)]) == cli.DONE
    assert f"vibralign assess --device {path}" in capsys.readouterr().out
    text = path.read_text(encoding="utf-8")
    for name in (*QUANTITIES, *LIMITS, "materials", "fit", "free", "limits", "start", "shape"):
        assert re.search(rf"\b{name}\b", text), name
        assert re.search(rf"\b{name}\b", TUTORIAL), name
    assert re.search(r"time: .* until it is aligned .*, not until it is inserted", text)
    assert cli.main(["simulate", "--device", str(path)]) == cli.REFUSED
    assert "mass is not filled in: must be a number in kg" in capsys.readouterr().err
    for name, value in FILLED.items():
        text = re.sub(rf"^{name}:", f"{name}: {value}", text, flags=re.MULTILINE)
    path.write_text(text, encoding="utf-8")
    stated = load_device(path)
    assert stated.doubts == []
    assert stated.quantities["inertia"] == pytest.approx(1.2e-4)
    path.write_text(re.sub(r"^# (?=\w+:|  )", "", text, flags=re.MULTILINE), encoding="utf-8")
    with pytest.raises(ValueError, match="contact_stiffness and materials state the same"):
        load_device(path)  # every example value is read
    text = re.sub(r"^# (?=(contact_\w+):)", "! ", text, flags=re.MULTILINE)
    text = re.sub(r"^# (?=\w+:|  )", "", text, flags=re.MULTILINE).replace("! ", "# ")
    path.write_text(text, encoding="utf-8")
    assert load_device(path).limits["vibration"] == 1.0


def test_nothing_is_overwritten(tmp_path, capsys):
    path = tmp_path / "own.yaml"
    path.write_text("mass: 1 kg\n", encoding="utf-8")
    assert cli.main(["new", str(path)]) == cli.REFUSED
    assert f"{path}: exists already" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == "mass: 1 kg\n"
