"""The report: one page that embeds its pictures and agrees with the datasets of all figures."""

import base64
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from model.events.outcomes import Outcome, Reason, Unvibrated
from model.physics.parameters import OF_PAPER
from model.physics.variants import VARIANT_NAMES
from model.sweeps.io import write_dataset
from study.claims import CLAIMS, tally
from study.jamming import entered, jammed, wedging_side
from study.report import background
from study.report.background import VARIANT_WORDS
from study.report.figures import HEAD, Counts
from study.report.findings import wedging_words
from study.report.section import Results, subscripts
from tests.study.report_data import PIXEL, Page, article, plain, render_report, words_of
from tests.vibralign.plots.drawn import jamming_data
from verification.bench.report.checks import CHECKS
from verification.bench.report.speed import cost_of
from vibralign.plots.words import percent

MOST_WORDS = 4000  # in sight when the page is opened


def test_the_page_is_well_formed_and_asks_for_nothing_from_outside(rendered):
    page = Page(rendered)
    assert page.open == []
    assert all("src" not in each for each in page.all("script"))
    assert not page.all("link")
    assert "@import" not in rendered
    assert "url(" not in rendered
    for image in page.all("img"):
        assert image["src"].startswith("data:image/")
    for anchor in page.all("a"):
        assert not re.match(r"[a-z]+:|/", anchor["href"])


def test_every_link_inside_the_page_leads_somewhere(rendered, study):
    page = Page(rendered)
    places = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(set(places)) == len(places)
    inside = [each["href"][1:] for each in page.all("a") if each["href"].startswith("#")]
    assert set(inside) <= set(places)
    assert set(inside) >= set(study.figures)


def test_every_figure_has_its_picture_with_words_for_who_cannot_see_it(rendered, study):
    images = Page(rendered).all("img")
    assert len(images) == len(study.figures) + 3
    others = [spec for name, spec in study.figures.items() if name != HEAD]
    for image, spec in zip(images, [study.figures[HEAD], *others], strict=False):
        assert base64.b64decode(image["src"].partition(",")[2]) == PIXEL
        assert spec.title in image["alt"]
        assert spec.caption.strip() in image["alt"]
        assert (image["width"], image["height"]) == ("1", "1")
    for name, spec in study.figures.items():
        shown = spec.caption.strip().replace("k_φ", "kφ")  # as a subscript
        assert f"{spec.title} {shown}" in article(rendered, name)


def test_files_are_linked_relative_to_the_results(rendered, study):
    links = {each["href"] for each in Page(rendered).all("a")}
    for name, spec in study.figures.items():
        assert {f"figures/{name}.{each}" for each in ("png", "svg", "pdf")} <= links
        assert (f"data/{name}.nc" in links) == (spec.kind != "schematic")


def test_outcomes_are_counted_from_the_datasets(rendered, datasets):
    part = rendered[rendered.index('id="glance"') : rendered.index("τ from")]
    table = re.sub(r"<[^>]*>", " ", part).split(" Fig. ")
    there = np.concatenate([each["outcome"].values.ravel() for each in datasets.values()])
    ends = [each for each in Outcome if each in there]
    for name, dataset in datasets.items():
        outcome = dataset["outcome"].values
        counted = [(outcome == each).sum() for each in ends]
        (row,) = (row for row in table if row.startswith(f"{int(name[3:])} "))
        numbers = re.sub(r"[\d.]+ %", "", row).split()  # without the shares
        chaotic = (dataset["reason"].values == Reason.CHAOTIC).sum()
        expected = [outcome.size, *counted, chaotic, dataset["sensitive"].sum()]
        assert [*map(int, numbers[1 : 1 + len(expected)])] == expected


def test_errors_are_summed_up_without_the_sensitive_points_and_chaotic_runs_are_counted(datasets):
    dataset = datasets["fig08"].copy(deep=True)
    assert Counts(dataset).chaotic == 0
    dataset["tau_error"][:] = np.nan
    dataset["tau_error"][0, :5] = [1e-9, 2e-9, 3e-9, 4e-9, 2.0]
    dataset["sensitive"][:] = 0
    dataset["sensitive"][0, 4] = 1
    dataset["reason"][0, :3] = Reason.CHAOTIC
    counts = Counts(dataset)
    assert counts.error(0.5) == pytest.approx(2.5e-9)
    assert counts.error(1.0) == 4e-9
    assert counts.error(1.0, sensitive=True) == 2.0
    assert counts.chaotic == 3


def test_a_figure_says_what_is_varied_and_what_is_held(rendered, study):
    text = article(rendered, "fig06")
    swept = study.figures["fig06"].swept
    assert f"Varied: f0 = {swept.start:g} to {swept.stop:g}, 10 values, kφ = 5, 7. Held: " in text
    held = re.search(r"Held: (.*?), and the device", text)[1]
    at = study.figures["fig06"].held
    assert held == f"μ = {at['friction']:g}, ν = {at['frequency']:g}"


def test_every_parameter_is_told(rendered):
    part = rendered[rendered.index('id="device"') : rendered.index('id="equations"')]
    for name in OF_PAPER:
        assert part.count(f"<td><code>{name}</code></td>") == 1


def test_the_page_says_what_the_twins_do(rendered, datasets):
    part = rendered[rendered.index('id="vibration"') : rendered.index('id="claims"')]
    part = words_of(part)
    dataset = datasets["fig08"]
    aligned = dataset["outcome"].values == Outcome.ALIGNED
    alone = (dataset["unvibrated"].values == Unvibrated.ALIGNS)[aligned].mean()
    assert f"Fig. 8 {aligned.sum():,} of {aligned.size:,} {percent(alone)}" in part


def test_circles_are_explained_where_there_are_some(study, root, datasets, tmp_path):
    assert "A circle marks" not in render_report(Results(root, study))
    some, data = shutil.copytree(root, tmp_path / "some"), datasets["fig09"].copy(deep=True)
    data["sensitive"].values[data["outcome"].values == Outcome.ALIGNED] = 1
    write_dataset(data, some / "data/fig09.nc")
    assert "A circle marks a\nsensitive point" in render_report(Results(some, study))


def test_few_words_are_in_sight_when_the_page_is_opened(rendered):
    page = Page(rendered)
    assert len(page.in_sight) <= MOST_WORDS
    assert len(page.words) > len(page.in_sight) + 1000  # the others are folded, not gone


def test_few_words_are_in_sight_of_the_smoke_report():
    """Run by .ci/run after `make smoke`."""
    report = Path(__file__).parents[2] / "results-smoke/report.html"
    if not report.is_file():
        pytest.skip("no results-smoke/report.html: run make smoke")
    text = report.read_text(encoding="utf-8")
    assert len(Page(text).in_sight) <= MOST_WORDS
    assert not re.search(r"\de[+-]\d\d", re.sub(r"data:image[^\"]*", "", text))


def test_numbers_are_written_without_a_computers_exponent(rendered):
    assert not re.search(r"\de[+-]\d\d", re.sub(r"data:image[^\"]*", "", rendered))


def test_error_against_cost_is_told_in_a_sentence_and_tables(rendered, study, timed_settings):
    part = rendered[rendered.index('id="speed"') : rendered.index('id="device"')]
    text = plain(part)
    assert cost_of(timed_settings, [*study.precision.cases]) in text
    for check in CHECKS:
        assert plain("".join(check)) in text
    for case in study.precision.cases.values():
        assert case.title in text
        assert case.reason in text


def test_every_case_has_its_cost_or_how_near_it_comes(rendered):
    part = rendered[rendered.index('id="speed"') : rendered.index('id="device"')]
    text = plain(part)
    assert "base ka = 100, ha = 0horizon reached10⁻¹²8error 3 × 10⁻⁴error 3 × 10⁻⁴" in text
    assert "slides and alignsaligned10⁻¹²8200 µs4,000200 µs4,000" in text
    assert "tilt through 90°left scene10⁻¹²8right outcomeright outcome" in text
    assert "ν = 0.001horizon reached10⁻¹²8too many evaluationstoo many evaluations" in text


def test_every_entry_is_told_with_its_numbers_limits_and_where_it_is_seen(rendered, lines):
    part = rendered[rendered.index('id="claims"') : rendered.index('id="jamming"')]
    text = plain(part)
    assert tally([line.verdict for line in lines]).capitalize() in text
    for line, claim in zip(lines, CLAIMS, strict=True):
        assert plain(str(subscripts(line.says))) in text
        assert f'id="claim-{line.claim}"' in part
        assert plain(str(subscripts(claim.reading))) in text
        for limit in claim.limits.values():
            assert plain(str(subscripts(limit.reason))) in text
    assert "L13" in text


def test_entries_stand_beside_those_of_other_devices_and_assumptions(rendered, lines):
    part = rendered[rendered.index('id="claims"') : rendered.index('id="jamming"')]
    text = words_of(part)
    own = len([line for line in lines if line.verdict == "shown"])
    every, half = len(CLAIMS), -(-len(CLAIMS) // 2)
    # Our figures; the device, pressed first, the narrow one and it pressed, on the coarse grid.
    assert f"all ({every}) {own} {every} 0 0 0" in text
    assert f"our device, on the same grid 1 {every} {every} {every}" in text
    assert f"the same, every unknown off by 5 % 1 {half} {half} {half}" in text
    assert f"first the press, then 0 {' '.join(c.id for c in CLAIMS)}" in text


def test_jamming_is_counted_beside_the_wedging_limit(rendered):
    part = rendered[rendered.index('id="jamming"') : rendered.index('id="speed"')]
    text = plain(part)
    data = jamming_data()
    fell, stuck = entered(data), jammed(data)
    assert f"Of {fell.sum()} parts that fall in" in text
    assert f"{percent(stuck.sum() / fell.sum())} jam" in text
    above = (stuck & wedging_side(data)).sum()
    below = (fell & ~wedging_side(data)).sum()
    assert above == stuck.sum() - 1  # one lacks force
    assert f"{above} of the {stuck.sum()} that jam lie above" in text
    assert f"below it 1 of {below} jam" in text
    rows = re.findall(r"<tr><td>(0\.0\d)</td>(.*?)</tr>", part, re.DOTALL)
    for (clearance, row), fallen, held in zip(rows, fell, stuck, strict=True):
        cells = re.findall(r'<td class="n">(\d+)</td>', row)
        assert clearance in ("0.03", "0.09")
        assert (int(cells[0]), int(cells[2])) == (fallen.sum(), held.sum())


def test_parts_that_go_in_above_the_wedging_limit_are_counted():
    flags = np.array([True, True, False])
    text = wedging_words(np.zeros(3, dtype=np.bool_), flags, flags[::-1], 0)
    assert text.startswith("1 of them lie above the textbook's wedging limit")


def test_provenance_is_printed_and_escaped(study, root, monkeypatch):
    monkeypatch.setattr(background, "versions", lambda: {"numpy": "2.1.0", "<llvmlite>": "0.44"})
    page = render_report(Results(root, study))
    text = page[page.index('id="provenance"') :]
    assert "<td>numpy</td><td><code>2.1.0</code></td>" in text
    assert "<td>&lt;llvmlite&gt;</td><td><code>0.44</code></td>" in text


def test_figures_open_live_where_the_explorer_is_built(rendered, study, root, datasets):
    assert "explorer.html" not in rendered
    links = [each["href"] for each in Page(render_report(Results(root, study, live=True))).all("a")]
    shown = sorted(each for each in links if each.startswith("explorer.html#"))
    assert shown == [f"explorer.html#figure={name}" for name in sorted(datasets)]


def test_every_file_that_the_page_shows_is_an_input(study, root):
    results = Results(root, study)
    render_report(results)
    assert set(results.inputs) == {path for path in root.rglob("*") if path.is_file()}


def test_every_switch_of_the_readings_is_explained(rendered):
    assert set(VARIANT_WORDS) == set(VARIANT_NAMES)
    assert all(f"<code>{name}</code>" in rendered for name in VARIANT_NAMES)


def test_words_from_the_configuration_are_escaped(study, root):
    spec = study.figures["fig06"].model_copy(update={"title": "<b>τ</b> & f0", "caption": '"<i>"'})
    hostile = study.model_copy(update={"figures": {**study.figures, "fig06": spec}})
    text = render_report(Results(root, hostile))
    assert "<b>τ</b>" not in text
    assert "&lt;b&gt;τ&lt;/b&gt; &amp; f0" in text
    assert Page(text).open == []


def test_the_same_inputs_give_the_same_page(rendered, study, root):
    assert render_report(Results(root, study)) == rendered


@pytest.mark.parametrize(
    "place", ["data/fig07.nc", "figures/fig01.png", "benchmarks/precision.csv"]
)
def test_what_is_missing_is_named(study, root, tmp_path, place):
    some = shutil.copytree(root, tmp_path / "some")
    (some / place).unlink()
    with pytest.raises(ValueError, match=f"needs .*{re.escape(place)}: build it"):
        render_report(Results(some, study))
