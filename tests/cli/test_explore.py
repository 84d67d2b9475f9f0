"""``vibralign explore`` and ``simulate --animate``: files, and refusals before anything is made."""

import json
import re
from pathlib import Path

import pytest

from model.cli import main as cli
from model.runs import in_browser
from model.runs.in_browser import Modules, interface

PEG = str(Path(__file__).parents[2] / "docs" / "peg.yaml")


@pytest.fixture
def engines(monkeypatch: pytest.MonkeyPatch) -> None:
    """Engines that are not compiled."""
    monkeypatch.setattr(in_browser, "modules", lambda: Modules(b"one", b"many", interface()))


def model_in(page: Path) -> dict:
    return json.loads(
        page.read_text(encoding="utf-8").partition('id="model">')[2].partition("</script>")[0]
    )


@pytest.mark.usefixtures("engines")
def test_a_device_gets_a_page_in_its_units(tmp_path, capsys):
    page = tmp_path / "peg.html"
    assert (
        cli.main(["explore", "--device", PEG, "--set", "press_force=12", "--out", str(page)]) == 0
    )
    assert str(page) in capsys.readouterr().out
    assert not re.search(r'(src|href)="(?!data:)|https?://', page.read_text(encoding="utf-8"))
    again = tmp_path / "again.html"
    cli.main(["explore", "--device", PEG, "--set", "press_force=12", "--out", str(again)])
    assert again.read_bytes() == page.read_bytes()
    assert model_in(page)["baseline"]["press_force"] == pytest.approx(12.0)
    origin = model_in(page)["origin"]
    assert origin["options"] == ["--device", PEG]
    assert origin["sets"] == {"press_force": "--set press_force=12"}


@pytest.mark.usefixtures("engines")
def test_without_a_device_the_page_is_that_of_the_study(tmp_path):
    page = tmp_path / "study.html"
    assert cli.main(["explore", "--out", str(page)]) == cli.DONE
    assert "fig13" in model_in(page)["presets"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--out", "peg.txt"], "must end in .html"),
        (["--out", "no/such/peg.html"], "does not exist"),
        (["--out", "peg.html", "--readings", "printed"], "consistent readings only"),
        (
            ["--out", "peg.html", "--scene", "insertion", "--insertion-depth", "0.2"],
            "default depth only",
        ),
    ],
)
def test_refusals(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["explore", *arguments]) == cli.REFUSED
    assert message in capsys.readouterr().err


def test_a_run_is_animated_as_a_page(device, tmp_path):
    page = tmp_path / "run.html"
    arguments = [
        "simulate",
        *(part for each in device.given().items() for part in ("--set", "{}={}".format(*each))),
        "--tolerance",
        "1e-6",
        "--animate",
        str(page),
    ]
    assert cli.main(arguments) == cli.DONE
    model = model_in(page)
    assert model["run"]["results"]["outcome"] == 0.0
    assert model["baseline"]["press_force"] == device.press_force


def test_an_animation_of_another_kind_is_refused(tmp_path, capsys):
    assert cli.main(["simulate", "--animate", str(tmp_path / "run.mp4")]) == cli.REFUSED
    assert "must end in .html" in capsys.readouterr().err
