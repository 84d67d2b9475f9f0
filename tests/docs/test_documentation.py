"""Functions, files and links that the documentation names exist, and it has one version."""

import ast
import re
import subprocess
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml

from study.schematics import DRAWINGS

REPOSITORY = Path(__file__).parents[2]
DOCS = REPOSITORY / "docs"
PAGES = [*REPOSITORY.glob("*.md"), *DOCS.rglob("*.md")]
HELD_BY = re.compile(r"^```\{held-by\}\n(.*?)^```", re.MULTILINE | re.DOTALL)
LABEL = re.compile(r"^\$\$ \((eq-\w+)\)$", re.MULTILINE)
LINK = re.compile(r"\]\(([^)#\s]+)\)")
FILE = re.compile(r"`((?:src|config|workflow|tests|docs|verification)/[\w./-]+\.\w+)`")


def definitions(path: Path) -> set[str]:
    nodes = ast.parse(path.read_text(encoding="utf-8")).body
    return {node.name for node in nodes if isinstance(node, ast.FunctionDef | ast.ClassDef)}


def text_of(pages: Path) -> dict[str, str]:
    return {path.name: path.read_text(encoding="utf-8") for path in sorted(pages.glob("*.md"))}


def test_every_function_that_the_theory_names_exists():
    for page, text in {**text_of(DOCS), **text_of(DOCS / "theory")}.items():
        for name in "".join(HELD_BY.findall(text)).split():
            module, _, function = name.rpartition(".")
            path = REPOSITORY / "src" / f"{module.replace('.', '/')}.py"
            assert path.is_file(), f"{page}: {name}"
            assert function in definitions(path), f"{page}: {name}"


def test_every_equation_of_the_theory_is_followed_by_its_function():
    printed_only = {"eq-1", "eq-2", "eq-3"}  # the paper's own, integrated as F6
    for page, text in text_of(DOCS / "theory").items():
        labels = LABEL.findall(text)
        assert len(set(labels)) == len(labels), page
        for label in set(labels) - printed_only:
            following = text.split(f"({label})\n", 1)[1]
            ends = [following.find(mark) for mark in ("```{held-by}", "\n## ")]
            held, section = (end if end >= 0 else len(following) for end in ends)
            assert held < section, f"{page}: {label}"


def test_a_drawing_stands_beside_the_equations():
    for page in ("frame.md", "motion.md", "contacts.md"):
        drawn = re.findall(r"^```\{drawing\} (\w+)$", text_of(DOCS / "theory")[page], re.MULTILINE)
        assert drawn, page
        assert set(drawn) <= set(DRAWINGS)


def test_every_part_of_the_physics_has_its_equation():
    named = "".join("".join(HELD_BY.findall(text)) for text in text_of(DOCS / "theory").values())
    for module in ("forces", "contacts", "motion", "geometry"):
        public = {
            name
            for name in definitions(REPOSITORY / f"src/model/physics/{module}.py")
            if name[0].islower() and not name.startswith("_")
        }
        # Arithmetic, questions, and ``motion`` once more.
        plain = {"dot", "is_beside", "is_supported", "never_sticks", "turning", "motion_at"}
        missing = {name for name in public - plain if f"physics.{module}.{name}" not in named}
        assert not missing


def test_every_walk_names_one_or_two_files_that_exist():
    text = (DOCS / "architecture.md").read_text(encoding="utf-8").partition("\n## Walks\n")[2]
    walks = text.split("\n### ")[1:]
    assert len(walks) >= 8
    for walk in walks:
        named = set(FILE.findall(walk))
        assert 1 <= len(named) <= 2, walk.partition("\n")[0]
        assert all((REPOSITORY / file).is_file() for file in named), named


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: page.name)
def test_files_that_a_page_names_exist(page):
    for file in FILE.findall(page.read_text(encoding="utf-8")):
        assert (REPOSITORY / file).exists(), file


def test_code_that_a_page_includes_exists():
    page = DOCS / "reference/configuration.md"
    shown = re.findall(r"literalinclude} (.*)\n:[\w-]+: (.*)", page.read_text(encoding="utf-8"))
    assert len(shown) >= 8
    for file, first in shown:
        assert first in (page.parent / file).read_text(encoding="utf-8"), (file, first)


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_and_files_of_the_top_pages_exist(name):
    text = (REPOSITORY / name).read_text(encoding="utf-8")
    for target in LINK.findall(text):
        assert "://" in target or (REPOSITORY / target).exists(), target


COMMIT = re.compile(r"\b(?:commit|at) `?([0-9a-f]{7,40})\b")


def test_commits_that_a_page_names_exist():
    if not (REPOSITORY / ".git").exists() or (REPOSITORY / ".git/shallow").exists():
        pytest.skip("no checkout with its history")
    named = {name for page in PAGES for name in COMMIT.findall(page.read_text(encoding="utf-8"))}
    assert len(named) >= 5
    asked = ["git", "-C", str(REPOSITORY), "cat-file", "--batch-check"]
    given = "".join(f"{name}^{{commit}}\n" for name in sorted(named))
    told = subprocess.run(asked, input=given, capture_output=True, text=True, check=True).stdout
    assert [line for line in told.splitlines() if line.split()[1:2] != ["commit"]] == []


def test_the_version_is_stated_once():
    citation = yaml.safe_load((REPOSITORY / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == version("vibralign")
    changelog = (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## {version('vibralign')}" in changelog
