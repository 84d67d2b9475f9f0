"""The explorer's page as a file, without running it: content, bytes, and what it must not hold."""

import base64
import gzip
import json
import re
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from model.events.outcomes import OUTCOME_TEXT, Outcome, Reason, remedy
from model.physics.parameters import FIELDS, OF_PAPER
from model.runs.in_browser import Module, interface
from study.config import load_study, study_path
from study.explorer import study_model
from vibralign.device import load_device
from vibralign.explorer import page as module
from vibralign.explorer.content import FIRST, device_model
from vibralign.explorer.page import SCRIPTS, build_page

STUDY = load_study(study_path())
INTERFACE = interface()
MODULE = Module(b"\0asm", INTERFACE)
PEG = Path(__file__).parents[2] / "square/peg.yaml"


def model_in(page: str) -> dict[str, Any]:
    """The model that a page holds, as its scripts read it."""
    text = page.partition('id="model">')[2].partition("</script>")[0]
    found: dict[str, Any] = json.loads(text)
    return found


def unpacked(text: str) -> bytes:
    return gzip.decompress(base64.b64decode(text))


@pytest.fixture(scope="module")
def page() -> str:
    return build_page(study_model(STUDY, INTERFACE), MODULE)


def test_the_same_inputs_give_the_same_bytes(page: str) -> None:
    assert build_page(study_model(STUDY, INTERFACE), MODULE) == page


def test_page_needs_no_network(page: str) -> None:
    assert re.findall(r'\b(?:src|href)="([^"]*)"', page) == ["data:,"]
    scripts = page.partition('"use strict";')[2]
    assert not re.search(r"https?://|fetch\(|XMLHttpRequest|import\(|@import|url\(", scripts)


def test_page_knows_every_parameter_outcome_and_remedy(page: str) -> None:
    model = model_in(page)
    assert {each["name"] for each in model["parameters"]} == set(OF_PAPER)
    for each in model["parameters"]:
        assert each["symbol"] == FIELDS[each["name"]].symbol
        assert each["least"] < each["most"]
    assert model["outcomes"]["0"] == OUTCOME_TEXT[Outcome.ALIGNED]
    of_reasons, remedies = model["remedies_of_reasons"], model["remedies"]
    for outcome, reason in product(Outcome, Reason):
        words = of_reasons.get(str(int(reason)), remedies[str(int(outcome))])
        assert words == remedy(outcome, reason)
    assert len(model["events"]) == len(INTERFACE["events"])
    assert unpacked(model["engine"]) == MODULE.binary


def test_presets_are_the_operating_points_of_figures_and_hard_cases(page: str) -> None:
    presets = model_in(page)["presets"]
    assert {name for name in presets if name.startswith("fig")} == {
        f"fig{n:02}" for n in range(5, 15)
    }
    for name in (each for each in presets if each.startswith("fig")):
        held = {**presets[name]["values"], **STUDY.figures[name].held}
        assert presets[name]["values"] == held
    assert len(presets) == 10 + len(STUDY.precision.hard.cases)


def test_text_cannot_end_the_script_that_holds_it() -> None:
    model = study_model(STUDY, INTERFACE)
    model["presets"]["fig06"]["words"] = "</script><b>"
    page = build_page(model, MODULE)
    assert page.count("</script>") == 2
    assert model_in(page)["presets"]["fig06"]["words"] == "</script><b>"


def test_a_device_has_its_own_units() -> None:
    device = load_device(PEG, {})
    settings = STUDY.settings.settings
    model = device_model(device, settings, INTERFACE)
    by_name = {each["name"]: each for each in model["parameters"]}
    force = by_name["press_force"]
    assert model["baseline"]["press_force"] == pytest.approx(10.0)
    assert force["unit"] == "N"
    assert [force["si"], force["one"], force["powers"][2]] == ["N", 1.0, 1]
    assert [by_name["half_width"]["unit"], by_name["half_width"]["one"]] == ["mm", 1e-3]
    assert force in model["parameters"][: len(FIRST)]
    assert model["time"]["si"] == "s"
    assert model["baseline"]["amplitude"] == device.quantities["amplitude"]


@pytest.mark.parametrize(("shape", "other"), [("round", "slot"), ("square", "hole")])
def test_a_round_part_has_a_hole_and_a_square_one_a_slot(shape: str, other: str) -> None:
    device = load_device(PEG, {})
    settings, of = STUDY.settings.settings, {**INTERFACE, "shape": shape}
    model = device_model(device, settings, of)
    texts = ("outcomes", "reasons", "remedies", "remedies_of_reasons", "unvibrated")
    said = [*model["events"], *(words for each in texts for words in model[each].values())]
    assert not [words for words in said if other in words]


def test_scripts_are_all_in_the_page() -> None:
    folder = Path(module.__file__).parent
    assert {each.name for each in folder.glob("*.js")} == {
        f"page.{name}.js" for name in (*SCRIPTS, "worker")
    }
