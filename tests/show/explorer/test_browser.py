"""The explorer in a real browser, headless: `make browser-test`."""

import io
import json
import shlex
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from model.cli import main as cli
from model.events.insertion import INSERTION
from model.runs.in_browser import interface, modules
from model.runs.shown import shown_run
from model.runs.simulate import simulate
from model.show.explorer.animation import FRAMES, run_gif, run_page
from model.show.explorer.browser import Page, browser, find_browser
from model.show.explorer.content import device_model, study_model
from model.show.explorer.page import build_page
from model.study.config import load_study, study_path

PATH = find_browser()
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(PATH is None, reason="no Chromium is installed; CHROMIUM names one"),
]
STUDY = load_study(study_path())
SETTINGS = replace(STUDY.settings.settings, scene=INSERTION)
MAPPED = "explorer.map && (explorer.map.stored || explorer.measured.map)"


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    made = modules()
    file = tmp_path_factory.mktemp("explorer") / "explorer.html"
    file.write_text(build_page(study_model(STUDY, made.interface), made), encoding="utf-8")
    return file.as_uri()


@pytest.fixture(scope="module")
def started() -> Iterator[Page]:
    with browser(str(PATH)) as page:
        yield page


@pytest.fixture
def page(started: Page, url: str) -> Iterator[Page]:
    """The page as it opens, still; no error may be left when the test ends."""
    started.open(f"{url}#figure=fig05&t=1")
    started.wait_for("window.explorer && explorer.run")
    yield started
    assert started.errors == []


def text(page: Page, name: str) -> str:
    found: str = page.evaluate(f"document.getElementById({json.dumps(name)}).textContent")
    return found


def slide(page: Page, name: str, value: float) -> None:
    page.evaluate(
        f"(() => {{ const slider = document.getElementById('s-{name}'); slider.value = {value};"
        "slider.dispatchEvent(new Event('input', {bubbles: true})); })()"
    )


def results(page: Page) -> dict[str, Any]:
    found: dict[str, Any] = page.evaluate("explorer.run.results")
    return found


def test_opens_with_the_run_of_python(page: Page) -> None:
    run = simulate(STUDY.parameters("fig05"), SETTINGS)
    assert results(page)["tau_align"] == pytest.approx(run.tau_align, abs=1e-8)
    assert results(page)["tau_inserted"] == pytest.approx(run.tau_inserted, abs=1e-8)
    assert text(page, "verdict").startswith("Aligned at τ = ")
    assert page.evaluate("explorer.run.track.rows") == len(run.time)


def test_a_slider_changes_the_run_and_the_address(page: Page) -> None:
    before = results(page)["tau_align"]
    slide(page, "press_force", 4.0)
    value = page.evaluate("explorer.state.values.press_force")
    run = simulate(STUDY.parameters("fig05").replace(press_force=value), STUDY.settings.settings)
    assert results(page)["tau_align"] == pytest.approx(run.tau_align, abs=1e-8)
    assert results(page)["tau_align"] != before
    assert f"press_force={value:g}" in page.evaluate("location.hash")


def test_an_address_restores_the_state(page: Page, url: str) -> None:
    slide(page, "friction", 0.2)
    page.evaluate("document.getElementById('vibration').click()")
    address, seen = page.evaluate("location.hash"), results(page)
    page.open(url + address)
    page.wait_for("window.explorer && explorer.run")
    assert results(page) == seen
    assert page.evaluate("explorer.state.vibration") is False
    assert page.evaluate("location.hash") == address


def test_without_vibration_is_the_run_at_frequency_0(page: Page) -> None:
    page.evaluate("document.getElementById('vibration').click()")
    still = STUDY.parameters("fig05").replace(frequency=0.0, phase=0.0)
    run = simulate(still, SETTINGS)
    assert results(page)["outcome"] == run.outcome


def test_the_page_says_what_vibration_changes(page: Page, url: str) -> None:
    page.open(f"{url}#figure=fig06&t=1")
    page.wait_for("window.explorer && document.getElementById('beside').textContent")
    words = text(page, "beside")
    assert words.startswith("Without vibration it comes to rest on the edge, tilted by ")
    assert words.endswith("only vibration brings it in.")
    page.evaluate("document.getElementById('vibration').click()")
    page.wait_for("document.getElementById('beside').textContent.startsWith('With vibration')")
    assert "comes to rest on the edge" in text(page, "words")
    assert text(page, "remedy") == ""


def test_a_value_outside_its_rule_is_refused_in_words(page: Page) -> None:
    before = results(page)
    page.evaluate(
        "(() => { const box = document.getElementById('p-friction'); box.value = '-1';"
        "box.dispatchEvent(new Event('change')); })()"
    )
    assert "friction must be a finite number >= 0" in text(page, "fault")
    assert results(page) == before


def test_events_are_stepped_with_the_keyboard(page: Page) -> None:
    page.evaluate("document.activeElement.blur(); explorer.seek(0)")
    page.press("ArrowRight", 39)
    assert "event: " in text(page, "moment")
    first = text(page, "moment")
    page.press("ArrowRight", 39)
    assert text(page, "moment") != first
    page.press(" ", 32)
    assert text(page, "play") == "Pause"


def test_a_map_is_computed_and_chosen_from(page: Page) -> None:
    page.wait_for(MAPPED, 300)
    # Every node has the outcome of a run.
    assert page.evaluate("explorer.map.outcome.every((each) => each >= 0)")
    box = page.evaluate(
        "(() => { const m = document.getElementById('map'); m.scrollIntoView();"
        "const b = m.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()"
    )
    before = page.evaluate("explorer.state.values")
    page.click(box[0] + 0.7 * box[2], box[1] + 0.3 * box[3])
    after = page.evaluate("explorer.state.values")
    changed = {name for name in after if after[name] != before[name]}
    assert changed == {page.evaluate("explorer.state.x"), page.evaluate("explorer.state.y")}
    page.evaluate("document.getElementById('map').focus()")
    page.press("ArrowUp", 38)
    y = page.evaluate("explorer.state.y")
    assert page.evaluate("explorer.state.values")[y] > after[y]
    # The node that is nearest to the run aligns if the run does.
    agrees = """(() => { const m = explorer.map, v = explorer.state.values, n = m.cells - 1;
        const at = (value, [low, high]) => Math.round(n * (value - low) / (high - low));
        const node = at(v[m.y], m.ys) * m.cells + at(v[m.x], m.xs);
        return (m.outcome[node] === 0) === Number.isFinite(explorer.run.results.tau_align); })()"""
    assert page.evaluate(agrees)


def test_command_and_device_file_repeat_the_run(
    page: Page, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    slide(page, "press_force", 4.0)
    page.evaluate("document.getElementById('command').click()")
    page.wait_for("document.getElementById('copied').textContent")
    command = shlex.split(text(page, "copied"))
    saved = tmp_path / "device.yaml"
    saved.write_text(page.evaluate("deviceOf(explorer.state, MODEL)"))
    for arguments in (command[1:], ["simulate", "--device", str(saved)]):
        assert cli.main([*arguments, "--json"]) == cli.DONE
        record = json.loads(capsys.readouterr().out)
        assert record["tau_align"] == pytest.approx(results(page)["tau_align"], abs=1e-8)


def test_every_preset_opens_and_plays_only_where_motion_is_wanted(page: Page, url: str) -> None:
    page.prefer_reduced_motion()
    page.open(url)
    page.wait_for("window.explorer && explorer.run")
    assert text(page, "play") == "Play"
    for name in page.evaluate("Object.keys(MODEL.presets)"):
        page.evaluate(
            f"(() => {{ const box = document.getElementById('preset'); box.value = '{name}';"
            "box.dispatchEvent(new Event('change')); })()"
        )
        assert page.evaluate("location.hash") == f"#figure={name}"
        assert text(page, "verdict")
        assert text(page, "fault") == ""


@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_wider_than_the_window(page: Page, url: str, width: int, tmp_path: Path) -> None:
    page.open(f"{url}#figure=fig13", width)
    page.wait_for("window.explorer && explorer.run")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    (tmp_path / f"explorer-{width}.png").write_bytes(page.picture(whole=True))


def test_every_control_has_a_name(page: Page) -> None:
    unnamed = """[...document.querySelectorAll("button, input, select, canvas")]
        .filter((each) => !(each.ariaLabel || each.labels?.length || each.textContent.trim()))
        .map((each) => each.id)"""
    assert page.evaluate(unnamed) == []


def test_a_run_as_a_page_and_as_a_gif(started: Page, tmp_path: Path) -> None:
    parameters, settings = STUDY.parameters("fig05"), STUDY.settings.settings
    model = device_model(parameters, None, "", settings, interface(), ["press_force"])
    made = run_page(model, shown_run(parameters, settings))
    file = tmp_path / "run.html"
    file.write_text(made, encoding="utf-8")
    started.errors.clear()
    started.open(file.as_uri())
    started.wait_for("window.explorer && explorer.run")
    assert text(started, "verdict").startswith("Aligned at τ = ")
    assert started.errors == []
    with Image.open(io.BytesIO(run_gif(made))) as gif:
        assert gif.n_frames > FRAMES // 2  # equal pictures are joined
        assert gif.size[0] > 400
