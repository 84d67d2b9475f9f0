"""Directive `held-by`: the functions that hold an equation, with their source folded.

Each line of its content is a dotted name, such as `model.physics.forces.press`. A name that does
not exist is a warning of Sphinx, and so an error of `make docs`.
"""

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

_SHOWN = """\
<details class="held-by"><summary><code>{function}</code> in {path}</summary>

```{{literalinclude}} /../{path}
:pyobject: {function}
```

</details>
"""


class HeldBy(SphinxDirective):
    """Show where functions stand and, folded, what they are."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return a folded block for each line of the content."""
        shown: list[nodes.Node] = []
        for name in self.content:
            module, _, function = name.rpartition(".")
            path = f"src/{module.replace('.', '/')}.py"
            shown += self.parse_text_to_nodes(_SHOWN.format(function=function, path=path))
        return shown


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("held-by", HeldBy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
