"""The examples of docs/reference/kernels.md are compiled, or refused, as they say."""

import doctest
import re
from pathlib import Path

from tests.model.compile.sources import load

PAGE = Path(__file__).parents[3] / "docs/reference/kernels.md"
TEXT = PAGE.read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


def test_the_examples_of_the_page_give_what_they_say(tmp_path: Path) -> None:
    kernels = load("\n\n".join(blocks("python")), tmp_path)
    told: list[str] = []
    for n, block in enumerate(blocks("pycon")):
        test = doctest.DocTestParser().get_doctest(
            block, dict(vars(kernels)), f"{PAGE.name} {n}", str(PAGE), 0
        )
        assert test.examples
        doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=told.append)
    assert not told, "".join(told)
