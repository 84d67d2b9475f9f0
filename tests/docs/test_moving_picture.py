"""The moving picture of README: what its two panels say is what the runs do."""

import math
from pathlib import Path

import pytest
from PIL import Image

from docs import moving_picture
from vibralign import INSERTION, Outcome, Settings, load_device, simulate

DOCS = Path(moving_picture.__file__).parent


def test_the_pressed_peg_rests_and_the_vibrated_one_goes_in() -> None:
    stated = load_device(DOCS / "peg.yaml", {})
    horizon = moving_picture.SHOWN / stated.units.time
    settings = Settings(scene=INSERTION, horizon=horizon)
    assert simulate(stated, settings).outcome is Outcome.INSERTED
    pressed = simulate(stated.changed(frequency=0.0), settings)
    assert pressed.outcome in (Outcome.SETTLED, Outcome.HORIZON_REACHED)
    assert math.isnan(pressed.tau_align)


def test_it_is_drawn_by_its_script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(moving_picture, "FRAMES", 4)
    monkeypatch.setattr(moving_picture, "HELD", 1)
    target = tmp_path / "picture.gif"
    moving_picture.main(target)
    with Image.open(target) as drawn, Image.open(DOCS / "alignment.gif") as kept:
        assert drawn.size == kept.size
        assert drawn.n_frames == 4
    assert (DOCS / "alignment.gif").stat().st_size < 1_000_000
