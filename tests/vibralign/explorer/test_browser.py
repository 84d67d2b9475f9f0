"""The explorer in a real browser, headless: `make browser-test`."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from model.events.insertion import INSERTION
from model.events.outcomes import Outcome
from model.physics.parameters import Batch
from model.runs.align import run_once
from model.runs.in_browser import module_for
from model.runs.simulate import simulate, simulate_once
from study.config import load_study, study_path
from study.explorer import study_model
from tests.vibralign.explorer.browser import Page, find_browser
from vibralign.explorer.page import build_page

PATH = find_browser()
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(PATH is None, reason="no Chromium is installed; CHROMIUM names one"),
]
STUDY = load_study(study_path())
SETTINGS = replace(STUDY.settings.settings, scene=INSERTION)
MAPPED = "explorer.measured.map"


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> str:
    made = module_for()
    file = tmp_path_factory.mktemp("explorer") / "explorer.html"
    file.write_text(build_page(study_model(STUDY, made.interface), made), encoding="utf-8")
    return file.as_uri()


@pytest.fixture
def page(started: Page, url: str) -> Iterator[Page]:
    """The page as it opens, still; no error may be left when the test ends."""
    started.show(f"{url}#figure=fig05&t=1")
    yield started
    assert started.errors == []


def test_opens_with_the_run_of_python(page):
    run = simulate(STUDY.parameters("fig05"), SETTINGS)
    assert page.results["tau_align"] == pytest.approx(run.tau_align, abs=1e-8)
    assert page.results["tau_inserted"] == pytest.approx(run.tau_inserted, abs=1e-8)
    assert page.text("verdict").startswith("Aligned at τ = ")
    once = simulate_once(STUDY.parameters("fig05"), SETTINGS)  # the page refines no run
    assert page.evaluate("explorer.run.track.rows") == len(once.time)


def test_a_slider_changes_the_run_and_the_address(page):
    before = page.results["tau_align"]
    page.slide("press_force", 0.9)
    value = page.evaluate("explorer.state.values.press_force")
    run = simulate(STUDY.parameters("fig05").replace(press_force=value), STUDY.settings.settings)
    assert page.results["tau_align"] == pytest.approx(run.tau_align, abs=1e-8)
    assert page.results["tau_align"] != before
    assert f"press_force={value:g}" in page.address


def test_an_address_restores_the_state(page, url):
    page.slide("friction", 0.2)
    page.evaluate("element('vibration').click()")
    address, seen = page.address, page.results
    page.show(url + address)
    assert page.results == seen
    assert page.evaluate("explorer.state.vibration") is False
    assert page.address == address


def test_without_vibration_is_the_run_at_frequency_0(page):
    page.evaluate("element('vibration').click()")
    still = STUDY.parameters("fig05").replace(frequency=0.0, phase=0.0)
    run = simulate(still, SETTINGS)
    assert page.results["outcome"] == run.outcome


def test_the_page_says_what_vibration_changes(page, url):
    page.open(f"{url}#figure=fig06&t=1")
    page.wait_for("window.explorer && element('beside').textContent")
    words = page.text("beside")
    assert words.startswith("Without vibration it rests on the edge, tilted by ")
    assert words.endswith("only vibration brings it in.")
    page.evaluate("element('vibration').click()")
    assert page.text("vibration") == "With vibration"
    assert page.text("map-title").endswith("without vibration")
    page.wait_for("element('beside').textContent.startsWith('With vibration')")
    assert "rests on the edge" in page.text("words")
    assert page.text("remedy") == ""


@pytest.mark.parametrize("given", ["-1", "abc", "", "0,1", "3 N"])
def test_a_value_outside_its_rule_is_refused_in_words(page, given):
    before, address = page.results, page.address
    page.type_in("friction", given)
    words = "must be a number without a unit" if given in ("0,1", "3 N") else ">= 0"
    assert page.text("fault").startswith(f"Not run: friction = {given or '(empty)'}: ")
    assert words in page.text("fault")
    assert all(page.text(each) == "" for each in ("verdict", "words", "remedy", "beside"))
    assert page.evaluate("element('p-friction').value") == given
    assert page.results == before
    page.evaluate("element('link').click()")
    assert page.text("said").startswith("Not copied: friction")
    # Another value is taken, and nothing runs until the first is mended.
    page.slide("press_force", 2.0)
    assert page.text("verdict") == ""
    assert page.address.startswith(address.partition("&")[0] + "&press_force=2")
    assert "friction" not in page.address
    page.type_in("friction", "0.1")
    assert page.text("verdict").startswith("Aligned")
    assert "friction=0.1" in page.address


def test_what_is_wrong_in_an_address_is_said(page, url):
    page.show(f"{url}#figure=fig99&friction=-1&mass=0&abc&vibration=maybe&t=-1")
    for said in ("figure = fig99", "friction = -1: must be", "mass: is no", "abc:", "vibration ="):
        assert said in page.text("ignored")
    assert page.evaluate("explorer.state.time") is None
    assert page.address == f"#figure={page.evaluate('MODEL.first')}"
    page.slide("press_force", 2.0)
    assert page.text("ignored") == ""
    page.show(f"{url}#figure=fig05&t=99")
    assert "inserted" in page.text("moment")


@pytest.mark.parametrize(
    "wrong", ["tilt_stiffness=-1", "press_force=0x2", "press_force=2 N", "friction=0.2", "abc"]
)
def test_a_refused_address_changes_nothing(page, wrong):
    page.slide("press_force", 0.9)
    before, seen = page.evaluate("explorer.state"), page.results
    page.evaluate(f"location.hash = '#figure=fig07&friction=0.3&{wrong}'")
    page.wait_for("element('ignored').textContent")
    assert page.text("ignored").startswith("The address is not taken: ")
    assert page.evaluate("explorer.state") == before
    assert page.results == seen
    page.wait_for("location.hash === hashOf(state, MODEL)")


def test_the_answer_does_not_wait_for_the_address(started, url):
    """Safari refuses more than 100 changes of the address in 30 s."""
    limit = """const write = history.replaceState.bind(history); let left = 3;
        history.replaceState = (...given) => {
          if (left-- <= 0) throw new DOMException("limit", "SecurityError");
          write(...given);
        };"""
    with started.beginning_with(limit):
        started.show(f"{url}#figure=fig05&t=1")
    for force in np.linspace(0.8, 1.4, 30):
        started.slide("press_force", force)
        started.evaluate("new Promise((done) => setTimeout(done, 60))")
    assert started.evaluate("location.hash !== hashOf(state, MODEL)")  # it was refused
    shown = float(started.evaluate("element('p-press_force').value"))
    run = simulate(STUDY.parameters("fig05").replace(press_force=shown), SETTINGS)
    assert started.results["tau_align"] == pytest.approx(run.tau_align, abs=1e-8)
    assert f"{run.tau_align:.4g}" in started.text("verdict")
    assert started.errors == []


def test_a_part_that_is_in_from_the_start_needs_no_comparison(page):
    page.type_in("half_width", "5")
    assert page.text("verdict") == "In from the start"
    page.evaluate("new Promise((done) => setTimeout(done, 300))")
    assert page.text("beside") == ""


def test_vibration_that_changes_nothing_is_called_so(page):
    same = "comparisonWords({tau_align: 1}, {tau_align: 1.001}, NaN, true)"
    assert page.evaluate(same).endswith("vibration changes nothing.")


def test_a_long_run_leaves_the_page_usable(page):
    page.type_in("frequency", "1e7")
    assert page.text("verdict").startswith("Computing")
    page.type_in("frequency", "6.5")
    assert page.text("verdict").startswith("Aligned")
    page.type_in("friction", "0")
    page.type_in("frequency", "1e4")
    assert page.text("verdict").startswith("Computing")
    page.wait_for("!document.body.classList.contains('stale')", 60)
    run = simulate(STUDY.parameters("fig05").replace(friction=0.0, frequency=1e4), SETTINGS)
    assert page.results["rhs_evaluations"] > page.evaluate("QUICK")
    assert page.results["outcome"] == run.outcome
    tau = page.results["tau_align"]
    assert (math.nan if tau is None else tau) == pytest.approx(run.tau_align, abs=1e-8, nan_ok=True)
    # The page keeps the first rows of its track.
    assert page.evaluate("explorer.run.track.rows") < page.results["tracked"]
    assert "The drawing ends at" in page.text("words")


def test_events_are_stepped_with_the_keyboard(page):
    page.evaluate("document.activeElement.blur(); explorer.seek(0)")
    page.press("ArrowRight", 39)
    assert "event: " in page.text("moment")
    first = page.text("moment")
    page.press("ArrowRight", 39)
    assert page.text("moment") != first
    page.press(" ", 32)
    assert page.text("play") == "Pause"


def test_a_map_is_computed_and_chosen_from(page):
    page.wait_for(MAPPED, 300)
    # Every node has an outcome.
    assert page.evaluate("explorer.map.outcome.every((each) => each >= 0)")
    box = page.evaluate(
        "(() => { const m = element('map'); m.scrollIntoView();"
        "const b = m.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()"
    )
    before = page.evaluate("explorer.state.values")
    page.click(box[0] + 0.7 * box[2], box[1] + 0.3 * box[3])
    after = page.evaluate("explorer.state.values")
    changed = {name for name in after if after[name] != before[name]}
    assert changed == {page.evaluate("explorer.state.x"), page.evaluate("explorer.state.y")}
    page.evaluate("element('map').focus()")
    page.press("ArrowUp", 38)
    y = page.evaluate("explorer.state.y")
    assert page.evaluate("explorer.state.values")[y] > after[y]
    # The node that is nearest to the run aligns if the run does.
    agrees = """(() => { const m = explorer.map, v = explorer.state.values, n = m.cells - 1;
        const at = (value, [low, high]) => Math.round(n * (value - low) / (high - low));
        const node = at(v[m.y], m.ys) * m.cells + at(v[m.x], m.xs);
        return (m.outcome[node] === 0) === Number.isFinite(explorer.run.results.tau_align); })()"""
    assert page.evaluate(agrees)


def test_a_map_is_computed_near_what_aligns_and_filled_elsewhere(page):
    # A disc and a finger one node wide that begins at it: in truth, and by the page's lattices.
    found = page.evaluate("""(() => {
        const cells = 65, map = emptyMap("x", "y", [0, 1], [0, 1], cells), { outcome } = map;
        const aligns = (node) => {
          const row = Math.floor(node / cells), column = node % cells;
          const inFinger = row === 21 && column > 30 && column < 60;
          return inFinger || Math.hypot(row - 20, column - 30) < 9;
        };
        let rounds = 0;
        for (let step = FIRST_STEP; ; rounds += 1) {
          const nodes = nodesOf(map, step);
          for (const node of nodes) outcome[node] = aligns(node) ? ALIGNED : SETTLED;
          if (step > 1) step /= 2; else if (!nodes.length) break;
        }
        const computed = outcome.filter((each) => each !== UNKNOWN).length;
        fill(map);
        const wrong = outcome.filter((each, node) => (each === ALIGNED) !== aligns(node)).length;
        return { computed, wrong, rounds };
    })()""")
    assert found["wrong"] == 0
    assert found["computed"] < 0.5 * 65**2
    assert found["rounds"] > 6  # the finger is followed


def test_a_node_that_is_filled_does_not_align(page, url):
    # A tongue of aligned points, narrower than a coarse cell, is missed. This device has none.
    given = {
        "half_width": 1.018, "half_height": 6.089, "inertia": 27.59, "lateral_stiffness": 0.224,
        "lateral_damping": 0.6475, "axial_damping": 1.953, "tilt_damping": 0.3322,
        "friction": 0.5, "frequency": 6.091,
    }  # fmt: skip
    values = "&".join(f"{name}={value}" for name, value in given.items())
    page.open(f"{url}#figure=fig13&{values}&t=1")
    page.wait_for("window.explorer && explorer.measured.map", 300)
    nodes = page.evaluate("""(() => {
        const { map } = explorer, nodes = [...map.step.keys()].filter((node) => !map.step[node]);
        return nodes.map((node) => [...valuesAt(map, node), map.outcome[node]]); })()""")
    assert len(nodes) > 1000
    names = page.evaluate("[explorer.state.x, explorer.state.y]")
    device = STUDY.parameters("fig13").replace(**given)
    sets = [replace(device, **dict(zip(names, node, strict=False))) for node in nodes]
    found = run_once(Batch.stack(sets), STUDY.settings.settings.quickest)
    assert not np.any(found["outcome"] == Outcome.ALIGNED)
    assert Outcome.ALIGNED not in {node[2] for node in nodes}


def test_every_preset_opens_and_plays_only_where_motion_is_wanted(page, url):
    page.prefer_reduced_motion()
    page.show(url)
    assert page.text("play") == "Play"
    for name in page.evaluate("Object.keys(MODEL.presets)"):
        page.set("preset", name, "change")
        assert page.address == f"#figure={name}"
        assert page.text("verdict")
        assert page.text("fault") == ""


@pytest.mark.parametrize("width", [1280, 400])
def test_nothing_is_wider_than_the_window(page, url, width, tmp_path):
    page.show(f"{url}#figure=fig13", width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    (tmp_path / f"explorer-{width}.png").write_bytes(page.picture(whole=True))


def test_verdict_and_drawing_stay_in_sight_on_a_small_screen(page, url):
    page.show(f"{url}#figure=fig05&t=1", 400, 800)
    for name in ("s-tilt_stiffness", "link"):
        page.evaluate(f"element('{name}').scrollIntoView({{block: 'center'}})")
        for shown in ("verdict", "scene"):
            box = page.evaluate(f"element('{shown}').getBoundingClientRect().toJSON()")
            assert 0 <= box["top"] < box["bottom"] < 400


@pytest.mark.parametrize(("low", "high"), [(0, 1), (19.87, 20.03), (-3e-4, 0.14), (0, 2.99)])
def test_an_axis_has_at_least_three_ticks(page, low, high):
    found = page.evaluate(f"ticks({low}, {high}, 3)")
    assert 3 <= len(found) <= 8
    assert all(low <= each <= high for each in found)


def test_every_control_has_a_name(page):
    unnamed = """[...document.querySelectorAll("button, input, select, canvas")]
        .filter((each) => !(each.ariaLabel || each.labels?.length || each.textContent.trim()))
        .map((each) => each.id)"""
    assert page.evaluate(unnamed) == []
