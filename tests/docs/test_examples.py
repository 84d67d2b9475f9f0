"""The examples of the README and the documentation run, and print what the pages show."""

import re
import shlex
from pathlib import Path

import pytest

from study import __main__ as of_study
from study.config import load_study, study_path
from vibralign.answers import leeways
from vibralign.commands import main as cli

REPOSITORY = Path(__file__).parents[2]
PAGES = [*REPOSITORY.glob("*.md"), *(REPOSITORY / "docs").rglob("*.md")]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(
    r"^(?: {4}|\$ )(?:\w+=\S+ )*(vibralign|python -m study|make|snakemake)\b([^#\n]*)", re.MULTILINE
)

INLINE = re.compile(r"`(vibralign|python -m study|make) ([^`\n]*)`")
PARSERS = {"vibralign": cli.parser(), "python -m study": of_study.parser()}


def name_of(path: Path) -> str:
    return str(path.relative_to(REPOSITORY))


def blocks(page: Path, language: str) -> list[str]:
    found = BLOCK.findall(page.read_text(encoding="utf-8"))
    return [text for kind, text in found if kind == language]


def with_blocks(language: str) -> list[Path]:
    return [page for page in PAGES if blocks(page, language)]


@pytest.mark.parametrize("page", with_blocks("python"), ids=name_of)
def test_python_runs(page, tmp_path, monkeypatch):
    for folder in ("docs", "examples"):
        (tmp_path / folder).symlink_to(REPOSITORY / folder)
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "data").symlink_to(REPOSITORY / "tests" / "reference")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "example"}
    for text in blocks(page, "python"):
        exec(compile(text, name_of(page), "exec"), names)  # noqa: S102 - our own pages


LEEWAY = re.compile(r"^(?:first to change|reliable with|fails from) .*\n", re.MULTILINE)
VARIED = "press_force"  # the leeway that `make test` compares; all take a minute
CONSOLE = {
    f"{name_of(page)}-{i}": text
    for page in with_blocks("console")
    for i, text in enumerate(blocks(page, "console"))
}
WITH_LEEWAYS = {name: text for name, text in CONSOLE.items() if LEEWAY.search(text)}
AT_ONCE = {name: text for name, text in CONSOLE.items() if name not in WITH_LEEWAYS}


def printed(text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture) -> str:
    """Run the command of a block, and return what it prints."""
    monkeypatch.chdir(REPOSITORY)
    command = text.partition("\n")[0]
    assert command.startswith("$ vibralign ")
    cli.main(shlex.split(command)[2:])
    return capsys.readouterr().out.rstrip("\n")


@pytest.mark.parametrize(
    "text",
    [
        *(pytest.param(text, id=name) for name, text in AT_ONCE.items()),
        *(
            pytest.param(text, id=name, marks=pytest.mark.nightly)
            for name, text in WITH_LEEWAYS.items()
        ),
    ],
)
def test_a_command_prints_what_the_page_shows(text, monkeypatch, capsys):
    excerpts = map(re.escape, text.partition("\n")[2].rstrip("\n").split("\n..."))
    assert re.fullmatch("(?:\n.*)+".join(excerpts), printed(text, monkeypatch, capsys))


@pytest.mark.parametrize("text", WITH_LEEWAYS.values(), ids=list(WITH_LEEWAYS))
def test_of_one_parameter_it_prints_the_leeway_that_the_page_shows(text, monkeypatch, capsys):
    """The rows on other parameters are left out."""
    monkeypatch.setattr(leeways, "VARIED", (VARIED,))
    monkeypatch.setattr(leeways, "UNITS", ())
    said, shown = printed(text, monkeypatch, capsys) + "\n", text.partition("\n")[2]
    [border] = re.findall(rf"{VARIED} \S+ \S+ \(stated .*?\)", said)
    assert border in shown
    assert LEEWAY.sub("", said) == LEEWAY.sub("", shown)


def check_make(words: list[str]) -> None:
    makefile = (REPOSITORY / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([\w-]+):", makefile, re.MULTILINE))
    variables = set(re.findall(r"^([A-Z_]+) ", makefile, re.MULTILINE))
    for word in words:
        name, is_variable, _ = word.partition("=")
        assert name in (
            variables if is_variable else targets | set(load_study(study_path()).figures)
        ), words


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_exist(page):
    text = page.read_text(encoding="utf-8")
    for program, rest in COMMAND.findall(text) + INLINE.findall(text):
        if program == "make":
            check_make(shlex.split(rest))
    for program, rest in COMMAND.findall(text):
        if program in PARSERS:
            words = [word for word in shlex.split(rest) if word != "--help"]
            PARSERS[program].parse_args(words)  # else SystemExit
    for program, rest in INLINE.findall(text):
        words = shlex.split(rest)
        if program in PARSERS and not words[0].startswith("-"):
            [commands] = (each for each in PARSERS[program]._actions if each.metavar == "command")
            options = set(commands.choices[words[0]]._option_string_actions)
            assert {word for word in words if word.startswith("--")} <= options, rest
