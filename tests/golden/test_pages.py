"""Every command of the study and every page of how-tos, on the golden build.

A command, an option or a page that is added is found here: it has no line in the tables below.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from study import __main__ as study

PROJECT = Path(__file__).resolve().parents[2]
HOWTO = PROJECT / "docs/howto"
BLOCK = re.compile(
    r"^```\{?([\w-]+)\}?[^\n]*\n(?::caption:[^\n]*\n+)?(.*?)^```", re.MULTILINE | re.DOTALL
)
COMMAND = re.compile(r"^ {4}((?:python -m study|snakemake|make|git|zip)\b[^#\n]*)", re.MULTILINE)

# Lines of every command: words, and the exit code. ROOT is the golden build, COPY another one,
# NEW a reference to be accepted from it, REFERENCE one that was.
LINES: dict[str, list[tuple[str, int]]] = {
    "runs": [("--root ROOT", 0), ("--root ROOT --figure 13 --json", 0),
             ("--root ROOT --outcome failed", 0), ("--root ROOT --starts", 0)],
    "show": [("--root ROOT last", 0), ("--root ROOT merge/fig13", 0), ("--root ROOT 1 --json", 0)],
    "diff": [("ROOT COPY", 0), ("ROOT COPY --all --json", 0)],
    "accept": [("--root ROOT --reference NEW --figure all --claims --reason 'a first'", 0)],
    "verify": [("--root ROOT --reference REFERENCE", 0),
               ("--root ROOT --reference REFERENCE --figure 13 --json", 0)],
    "claims": [("--root ROOT", 0), ("--root ROOT --json", 0)],
}  # fmt: skip


def commands() -> dict[str, argparse.ArgumentParser]:
    """The parsers of the commands by name."""
    (found,) = (each for each in study.parser()._actions if each.metavar == "command")
    return dict(found.choices)


def test_every_command_and_option_has_a_line() -> None:
    assert commands().keys() == LINES.keys()
    for name, parser in commands().items():
        written = {word for line, _ in LINES[name] for word in shlex.split(line)}
        assert set(parser._option_string_actions) - {"-h", "--help"} <= written, name


@pytest.fixture(scope="module")
def places(results: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("places")
    shutil.copytree(results, folder / "copy")
    found = {name: str(folder / name) for name in ("NEW", "REFERENCE")}
    ((accept, _),) = LINES["accept"]
    words = accept.replace("NEW", found["REFERENCE"]).replace("ROOT", str(results))
    assert study.main(["accept", *shlex.split(words)]) == 0
    return {"ROOT": str(results), "COPY": str(folder / "copy"), **found}


@pytest.mark.parametrize(
    ("name", "line", "code"),
    [(name, line, code) for name, lines in LINES.items() for line, code in lines],
)
def test_a_command_works_on_a_build(
    capsys: Any, places: dict[str, str], name: str, line: str, code: int
) -> None:
    words = [places.get(word, word) for word in shlex.split(line)]
    assert study.main([name, *words]) == code, capsys.readouterr().err
    assert capsys.readouterr().err == ""


def test_runs_of_a_figure_are_its_own(capsys: Any, results: Path) -> None:
    study.main(["runs", "--root", str(results), "--figure", "13", "--json"])
    runs = {each["run"] for each in yaml.safe_load(capsys.readouterr().out)}
    assert "merge/fig13" in runs
    assert not [run for run in runs if "round" in run]


# --- How-tos ------------------------------------------------------------------------------------

# The test that walks each page; those of other files by their path.
WALKED = {
    "accept-a-change": "test_a_page_of_commands",
    "add-a-claim": "test_an_entry_is_added_as_the_page_says",
    "add-a-contact": "tests/model/events/test_insertion.py",
    "add-a-figure": "test_a_figure_is_added_as_the_page_says",
    "add-a-force": "tests/test_tables.py",
    "deposit": "test_a_page_of_commands",
    "explore": "tests/vibralign/commands/test_explore.py",
    "index": "test_every_page_is_walked",
    "read-a-dataset": "tests/docs/test_examples.py",
    "restart": "test_a_page_of_commands",
    "run-on-a-cluster": "tests/workflow/test_slurm.py",
    "see-what-vibration-adds": "tests/docs/test_examples.py",
    "study-in-python": "tests/docs/test_examples.py",
}


def test_every_page_is_walked() -> None:
    assert {page.stem for page in HOWTO.glob("*.md")} == WALKED.keys()
    for walk in WALKED.values():
        assert walk in globals() or (PROJECT / walk).is_file(), walk


def blocks(page: str, language: str) -> list[str]:
    found = BLOCK.findall((HOWTO / f"{page}.md").read_text(encoding="utf-8"))
    return [text for kind, text in found if kind == language]


@pytest.mark.parametrize(
    "page", [name for name, walk in WALKED.items() if walk == "test_a_page_of_commands"]
)
def test_a_page_of_commands(
    copy_of_built: Any, capsys: Any, monkeypatch: pytest.MonkeyPatch, page: str
) -> None:
    """The commands of the page, in their order; what builds a study builds the copy's."""
    made = copy_of_built
    monkeypatch.chdir(made.folder)
    shutil.copytree(PROJECT / "tests/reference", made.folder / "tests/reference")
    subprocess.run(["git", "init", "-q"], check=True)
    (made.folder / "results").symlink_to("tiny")
    (made.folder / "results-smoke").symlink_to("tiny")
    lines = COMMAND.findall((HOWTO / f"{page}.md").read_text(encoding="utf-8"))
    assert len(lines) >= 3
    for line in lines:
        words = shlex.split(line.replace(" A B", " tiny results"))
        if words[:3] == ["python", "-m", "study"]:
            code = study.main(words[3:])
            assert code <= (words[3] in ("verify", "diff")), (line, capsys.readouterr().err)
        elif words[0] == "snakemake" or words in (["make"], ["make", "smoke"]):
            options = [word for word in words[1:] if word not in ("smoke", "-c2")]
            run = made.forked(*options)
            assert run.returncode == 0, run.stdout + run.stderr
        elif words[0] in ("git", "zip") and shutil.which(words[0]) and words[1] != "archive":
            subprocess.run(words, check=True, capture_output=True)


def test_a_figure_is_added_as_the_page_says(copy_of_built: Any, tiny: dict[str, Any]) -> None:
    """Two files; then a rule of its own, with a script; and the report has the figure."""
    made = copy_of_built
    (stated, *_) = blocks("add-a-figure", "yaml")
    config = made.folder / "config/config.yaml"
    text = config.read_text(encoding="utf-8").rstrip("\n") + "\n"
    config.write_text(text + re.sub("^", "  ", stated, flags=re.MULTILINE), encoding="utf-8")
    small = re.search(
        r"^ {4}(fig15: \{.*\})$", (HOWTO / "add-a-figure.md").read_text("utf-8"), re.MULTILINE
    )
    assert small
    tiny["figures"] |= yaml.safe_load(small[1].replace("25", "4"))
    made.configure(tiny)
    run = made.dry_run("fig15")
    assert run.returncode == 0, run.stdout
    script, rule = blocks("add-a-figure", "code-block")
    (made.folder / "workflow/scripts/histogram.py").write_text(script, encoding="utf-8")
    with (made.folder / "workflow/rules/pictures.smk").open("a", encoding="utf-8") as pictures:
        pictures.write(f"\n\n{rule}")
    run = made.forked("tiny/figures/fig13_histogram.png", "all")
    assert run.returncode == 0, run.stdout + run.stderr
    assert (made.folder / "tiny/figures/fig13_histogram.png").is_file()
    assert (made.folder / "tiny/figures/fig15.pdf").is_file()
    assert 'id="fig15"' in (made.folder / "tiny/report.html").read_text(encoding="utf-8")


# --- One change, few files ----------------------------------------------------------------------


def in_a_copy(folder: Path, edits: dict[str, tuple[str, str]], program: str) -> str:
    """Return what a program prints that runs on a copy of the sources with an edit a file."""
    shutil.copytree(PROJECT / "src", folder / "src", ignore=shutil.ignore_patterns("__pycache__"))
    for file, (old, new) in edits.items():
        text = (PROJECT / file).read_text(encoding="utf-8")
        assert old in text
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(text.replace(old, new, 1), encoding="utf-8")
    paths = {"PYTHONPATH": os.pathsep.join([str(folder / "src"), str(folder)])}
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, env={**os.environ, **paths},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_an_entry_is_added_as_the_page_says(tmp_path: Path) -> None:
    """Three files: its statement, its check, and figures against it."""
    (stated,), (check,) = (blocks("add-a-claim", each) for each in ("yaml", "python"))
    stated = re.sub("^", "  ", stated.replace("L24", "L99").rstrip(), flags=re.MULTILINE)
    _, function = check.replace("def l24", "def l99").split("\n\n\n")
    edits = {
        "src/study/claims/claims.yaml": ("entries:\n", f"entries:\n{stated}\n"),
        "src/study/claims/checks.py": ("\n\n\ndef l01", f"\n\n\n{function}\n\n\ndef l01"),
        "tests/study/made.py": (
            '    "L24": [', '    "L99": [made("fig12", lambda _, f: 30.0 - f)],\n    "L24": ['
        ),
    }  # fmt: skip
    assert len(edits) == 3
    told = in_a_copy(
        tmp_path,
        edits,
        "from study.claims import CLAIMS, judge\n"
        "from tests.study.made import WORLD, WRONG\n"
        "for figures in (WORLD, {**WORLD, 'fig12': WRONG['L99'][0]}):\n"
        "    print(*(found.verdict for claim, found in judge(figures) if claim.id == 'L99'))\n",
    )
    assert told.splitlines() == ["shown", "not shown"]


def test_a_unit_is_a_line_in_one_file(tmp_path: Path) -> None:
    table = "_SPELLINGS: tuple[tuple[str, str, str], ...] = (\n"
    row = '    (r"\\bponds?\\b", "gram_force", "N"),\n'
    told = in_a_copy(
        tmp_path,
        {"src/vibralign/device/spelling.py": (table, table + row)},
        "from vibralign.device.amounts import read_amount\n"
        "print(read_amount('press_force', '200 ponds', 'N').value)\n",
    )
    assert float(told) == pytest.approx(0.2 * 9.80665)
