"""Results of a small study as the report takes them, and a parser of the page."""

import base64
import re
from html.parser import HTMLParser

import numpy as np
import pytest
import xarray as xr

from model.sweeps.io import write_dataset
from model.sweeps.sweep import merge, run
from study.claims import CLAIMS, VERDICTS, figure_of, judge
from study.claims.ledger import ledger_text, lines_of
from study.claims.locked import locked_of
from study.plans import sweep_of
from study.report import page as report_page
from study.report.section import Results
from tests.vibralign.plots.drawn import jamming_data
from verification.bench.report import SECTIONS
from verification.bench.work_precision import table_of as settings_table

# The smallest picture there is: one transparent pixel.
PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNkYPhfDwAChwGA60e6kgAAAABJRU5ErkJggg=="
)
VOID = {"meta", "img", "br", "link", "input", "hr"}


def render_report(results):
    return report_page.render_report(results, SECTIONS)


class Page(HTMLParser):
    """Elements of a page, its words, those in sight, and whether every element was closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.in_sight: list[str] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if {"style", "script", "title"} & {*self.open}:
            return
        self.words += data.split()
        if self.open.count("details") == self.open.count("summary"):
            self.in_sight += data.split()

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def article(text: str, name: str) -> str:
    """The article on one figure, without tags and with single spaces."""
    part = re.search(rf'<article aria-labelledby="{name}">.*?</article>', text, re.DOTALL)
    assert part
    return plain(part[0])


def plain(html: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", "", html)).replace("&#39;", "'")


def words_of(html: str) -> str:
    """The words of a table, with spaces between its cells."""
    return " ".join(re.sub(r"<[^>]*>", " ", html).split())


@pytest.fixture(scope="module")
def study(small_study):
    return small_study(points=10, cells=5)


@pytest.fixture(scope="module")
def datasets(study):
    found = {}
    for name, spec in study.figures.items():
        if spec.kind != "schematic":
            sweep = sweep_of(study, name)
            found[name] = merge(sweep, spec.title, [run(sweep)])
    return found


def cases_data() -> xr.Dataset:
    """Verdicts on the device, off by a little, under an assumption, and on another device.

    The device shows every entry, the one off by a little every other one, the others none.
    """
    verdicts = np.full((5, len(CLAIMS)), VERDICTS.index("not shown"), dtype=np.int8)
    verdicts[0], verdicts[1, ::2] = 0, 0
    titles = [
        "as the study assumes",
        "off by 5 %",
        "first the press, then",
        "narrow",
        "narrow, pressed",
    ]
    return xr.Dataset(
        {
            "verdict": (("case", "entry"), verdicts),
            "kind": ("case", np.array([0, 1, 2, 3, 3], np.int8)),
            "random": ("device", np.array([2, 7, 9, 14], np.int8)),
        },
        {"case": titles, "entry": [claim.id for claim in CLAIMS]},
        {"figure": "cases"},
    )


@pytest.fixture(scope="module")
def lines(study, datasets):
    figures = {name: figure_of(dataset) for name, dataset in datasets.items()}
    figures["locked"] = locked_of(figures, study.settings.settings)
    return lines_of(judge(figures), {claim.id: 0.25 for claim in CLAIMS})


@pytest.fixture(scope="module")
def root(study, datasets, lines, timed_settings, tmp_path_factory):
    root = tmp_path_factory.mktemp("results")
    for name, dataset in datasets.items():
        write_dataset(dataset, root / f"data/{name}.nc")
    for name, dataset in {"jamming": jamming_data(), "cases": cases_data()}.items():
        write_dataset(dataset, root / f"data/{name}.nc")
    sweep = sweep_of(study, "fig13_round")
    if_round = merge(sweep, study.spec_of("fig13_round").title, [run(sweep)])
    write_dataset(if_round, root / "data/fig13_round.nc")
    (root / "claims.csv").write_text(ledger_text(lines), encoding="utf-8")
    for folder in ("benchmarks", "figures"):
        (root / folder).mkdir()
    measured = settings_table(timed_settings, times=True)
    (root / "benchmarks/precision.csv").write_text(measured, encoding="utf-8")
    drawn = "jamming", "fig13_vibration", "fig13_round"
    places = [f"figures/{name}" for name in (*study.figures, *drawn)]
    for place in places:
        (root / f"{place}.png").write_bytes(PIXEL)
    return root


@pytest.fixture(scope="module")
def rendered(study, root):
    return render_report(Results(root, study))
