"""Directive `held-by`: the functions of the model that hold an equation, with their source.

Each line of its content is a dotted name below `model`, such as `physics.forces.press`. A name that
does not exist is a warning, and so an error of `make docs`; the source is shown folded.
"""

import ast
from html import escape
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

_REPOSITORY = Path(__file__).parents[2]


def source_of(name: str) -> tuple[Path, str]:
    """Return file, relative to the repository, and source of a function or class of the packages.

    Raises:
        LookupError: no such file, or no such definition in it.
    """
    module, _, function = name.rpartition(".")
    path = _REPOSITORY / "src" / (module.replace(".", "/") + ".py")
    if not path.is_file():
        raise LookupError(f"{name}: no file {path.relative_to(_REPOSITORY)}")
    text = path.read_text(encoding="utf-8")
    for node in ast.parse(text).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == function:
            lines = text.splitlines()[node.lineno - 1 : node.end_lineno]
            return path.relative_to(_REPOSITORY), "\n".join(lines)
    raise LookupError(f"{name}: {path.relative_to(_REPOSITORY)} does not define {function}")


class HeldBy(SphinxDirective):
    """Show where functions stand and, folded, what they are."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return a folded block for each line of the content."""
        shown: list[nodes.Node] = []
        for name in self.content:
            try:
                path, text = source_of(name)
            except LookupError as missing:
                shown.append(self.state.document.reporter.warning(str(missing), line=self.lineno))
                continue
            self.env.note_dependency(str(_REPOSITORY / path))
            function = escape(name.rpartition(".")[2])
            summary = f"<summary><code>{function}</code> in {escape(str(path))}</summary>"
            code = nodes.literal_block(text, text, language="python")
            shown += [
                nodes.raw("", f'<details class="held-by">{summary}', format="html"),
                code,
                nodes.raw("", "</details>", format="html"),
            ]
        return shown


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("held-by", HeldBy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
