"""Render mathematics as MathML when the site is built: no script, no font and no network needed.

An equation is numbered by its label: `eq-3` is the paper's (3), `eq-C1` the first of this project's
equations on contacts. The paper numbers three of its equations; those numbers stay its own.
"""

import re

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

# A function's name that no bracket follows: a thin space belongs behind it.
_FUNCTION = re.compile(r"(<mi>(?:sin|cos|tan)</mi>)(?!<mo[^>]*>&#x00028;)")
_log = logging.getLogger(__name__)


def _mathml(node: nodes.Node, display: str) -> str:
    """Return a node as MathML; warn of a command that the converter passes on as text."""
    result = convert(node.astext(), display=display)
    if "\\" in result or "<mi>&</mi>" in result:
        _log.warning("unknown command in the equation %s", node.astext(), location=node)
    return _FUNCTION.sub(r'\1<mspace width="0.17em" />', result)


def _inline(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(_mathml(node, "inline"))
    raise nodes.SkipNode


def _display(self: HTML5Translator, node: nodes.math_block) -> None:
    self.body.append(self.starttag(node, "div", CLASS="math notranslate nohighlight"))
    if node["number"]:
        self.body.append(f'<span class="eqno">({get_node_equation_number(self, node)})')
        self.add_permalink_ref(node, "Link to this equation")
        self.body.append("</span>")
    self.body.append(f'<div class="formula">{_mathml(node, "block")}</div></div>\n')
    raise nodes.SkipNode


def _number_by_label(app: Sphinx, doctree: nodes.document) -> None:
    equations = app.env.domains.math_domain.equations
    for node in doctree.findall(nodes.math_block):
        if label := node.get("label"):
            node["number"] = label.removeprefix("eq-")
            equations[label] = (app.env.docname, node["number"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer, and the numbering of equations by their labels."""
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    app.connect("doctree-read", _number_by_label)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
