"""Directive `drawing`: one of Figs. 1 to 4 or of the crescent, for the tutorial's peg."""

from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from docs import round_drawings
from study.schematics import DRAWINGS
from vibralign import load_device
from vibralign.plots.style import write

_DOCS = Path(__file__).parents[1]
_DRAWINGS = {**DRAWINGS, **round_drawings.DRAWINGS}


class Drawing(SphinxDirective):
    """Show the figure that the argument names, with the content as its caption."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the drawing; raise KeyError for an unknown name."""
        target = _DOCS.parent / "build" / "drawings" / f"{self.arguments[0]}.png"
        target.parent.mkdir(parents=True, exist_ok=True)
        device = load_device(_DOCS / "peg.yaml")
        write(_DRAWINGS[self.arguments[0]](device.parameters), target)
        words, _ = self.parse_inline(" ".join(self.content))
        caption = nodes.caption("", "", *words)
        uri = f"/../build/drawings/{target.name}"
        image = nodes.image(uri=uri, alt=caption.astext(), width="600px")
        return [nodes.figure("", image, caption, align="center")]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("drawing", Drawing)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
