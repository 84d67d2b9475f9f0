"""``vibralign explore``: its file."""

import json
from pathlib import Path

import pytest

from model.runs import in_browser
from model.runs.in_browser import Module, interface
from vibralign.commands import main as cli

PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")


@pytest.fixture
def engine(monkeypatch: pytest.MonkeyPatch) -> None:
    """An engine that is not compiled."""
    monkeypatch.setattr(in_browser, "module_for", lambda *_: Module(b"one", interface()))


def model_in(page: Path) -> dict:
    return json.loads(
        page.read_text(encoding="utf-8").partition('id="model">')[2].partition("</script>")[0]
    )


@pytest.mark.usefixtures("engine")
def test_a_device_gets_a_page_in_its_units(tmp_path, capsys):
    page = tmp_path / "peg.html"
    assert (
        cli.main(["explore", "--device", PEG, "--set", "press_force=12", "--out", str(page)]) == 0
    )
    assert str(page) in capsys.readouterr().out
    assert model_in(page)["baseline"]["press_force"] == pytest.approx(12.0)
    assert model_in(page)["presets"]["device"]["title"] == PEG
