"""Pictures that look different are shown side by side."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imsave

from model.show.before_after import differing_pictures, write_page


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    root, reference = tmp_path / "results", tmp_path / "reference"
    (root / "figures").mkdir(parents=True)
    reference.mkdir()
    white, grey = np.ones((20, 30, 3)), np.full((20, 30, 3), 0.5)
    almost = white - 0.002
    for name, old, new in (
        ("fig01", white, white),
        ("fig02", white, almost),
        ("fig03", white, grey),
        ("fig04", white, white[:10]),
    ):
        imsave(reference / f"{name}.png", old)
        imsave(root / "figures" / f"{name}.png", new)
    return root, reference


def test_only_what_an_eye_would_notice_is_listed(folders: tuple[Path, Path]) -> None:
    found = differing_pictures(*folders, ["fig01", "fig02", "fig03", "fig04", "fig05"])
    assert list(found) == ["fig03", "fig04"]
    assert found["fig04"] == "30 × 20 became 30 × 10"
    assert "colours differ by" in found["fig03"]


def test_the_page_holds_both_pictures(folders: tuple[Path, Path]) -> None:
    page = write_page({"fig03": "colours differ"}, *folders).read_text(encoding="utf-8")
    assert page.count('src="data:image/png;base64,') == 2
    assert "fig03: colours differ" in page
