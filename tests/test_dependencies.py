"""Every third-party import is declared in pyproject.toml, in the group of its folder."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
STATED = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
OWN = {"model", "vibralign", "study", "verification", "docs", "tests"}
DISTRIBUTIONS = {
    "PIL": "pillow",
    "yaml": "pyyaml",
}  # where the import's name differs
GROUPS: dict[str, tuple[str, ...]] = {  # of each folder, besides the dependencies of the wheel
    "src/model": (),
    "src/vibralign": (),
    "src/study": ("study",),
    "workflow": ("study",),
    "verification": ("study", "bench"),
    "docs": ("docs",),
    "examples": (),
    "tests": ("study", "dev"),
}


def imports(folder: Path) -> Iterator[tuple[str, Path]]:
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [each.name for each in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module]
            yield from ((name.split(".")[0], path.relative_to(ROOT)) for name in names)


@pytest.mark.parametrize("folder", GROUPS)
def test_imports_are_declared(folder: str) -> None:
    lists = [STATED["project"]["dependencies"]]
    lists += [STATED["dependency-groups"][group] for group in GROUPS[folder]]
    declared = {re.split("[<>=~ ]", each, maxsplit=1)[0].lower() for one in lists for each in one}
    known = sys.stdlib_module_names | OWN
    undeclared = [
        f"{path}: {name}"
        for name, path in imports(ROOT / folder)
        if name not in known and DISTRIBUTIONS.get(name, name).lower() not in declared
    ]
    assert not undeclared
