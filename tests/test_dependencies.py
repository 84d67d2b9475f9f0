"""Every third-party import is declared in pyproject.toml, in the extra of its folder."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OWN = {"model", "vibralign", "study", "benchmarks", "verification", "docs", "tests"}
DISTRIBUTIONS = {
    "PIL": "pillow",
    "yaml": "pyyaml",
}  # where the import's name differs
STUDY = ["plot", "study"]
EXTRAS = {  # of each folder, besides the dependencies of the package
    **{f"src/model/{name}": () for name in ("compile", "physics", "events", "engine", "runs")},
    "src/model/sweeps": STUDY,
    "src/vibralign": STUDY,
    "src/study": STUDY,
    "workflow": STUDY,
    "verification": STUDY,
    "benchmarks": [*STUDY, "bench"],
    "docs": ["plot", "docs"],
    "examples": STUDY,
    "tests": [*STUDY, "dev"],
}


def imports(folder: Path) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [each.name for each in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module]
            yield from ((name.split(".")[0], path.relative_to(ROOT)) for name in names)


@pytest.mark.parametrize("folder", EXTRAS)
def test_imports_are_declared(folder: str) -> None:
    lists = [PROJECT["dependencies"]]
    lists += [PROJECT["optional-dependencies"][extra] for extra in EXTRAS[folder]]
    declared = {re.split("[<>=~ ]", each, maxsplit=1)[0].lower() for one in lists for each in one}
    known = sys.stdlib_module_names | OWN
    undeclared = [
        f"{path}: {name}"
        for name, path in imports(ROOT / folder)
        if name not in known and DISTRIBUTIONS.get(name, name).lower() not in declared
    ]
    assert not undeclared


def test_every_folder_has_a_rule() -> None:
    packages = {path.parent for path in (ROOT / "src" / "model").glob("*/__init__.py")}
    assert {path.relative_to(ROOT).as_posix() for path in packages} <= set(EXTRAS)
