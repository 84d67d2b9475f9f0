"""The page: its sections in order; methods and tables are folded."""

from collections.abc import Callable, Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from model.show.report import (
    answer,
    background,
    claims,
    figures,
    jamming,
    vibration,
)
from model.show.report.section import Results, Section, subscripts
from model.show.style import FORMATS
from model.show.words import number, percent, power, short

Make = Callable[[Results], Section | None]

# In the order of the page. Each returns None where the study has nothing to show; the provenance
# comes last, since it names the files that the others took.
FINDINGS: tuple[Make, ...] = (
    answer.section,
    figures.figures,
    vibration.section,
    claims.section,
    jamming.section,
)
BACKGROUND: tuple[Make, ...] = (background.device, background.equations, background.provenance)
_FOLDER = Path(__file__).parent


def render_report(results: Results, more: Sequence[Make] = ()) -> str:
    """Return the page as HTML; the same inputs give the same text.

    The sections of ``more``, from outside the package, stand between findings and background.

    Links to datasets (``data/fig06.nc``) and figures (``figures/fig06.svg``) are relative to the
    results root, where the page belongs.

    Raises:
        ValueError: a file is missing.
    """
    environment = Environment(
        loader=FileSystemLoader(_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        number=number, power=power, percent=percent, short=short, subscripts=subscripts
    )
    environment.globals["formats"] = FORMATS
    makes = (*FINDINGS, *more, *BACKGROUND)
    made = [section for make in makes if (section := make(results)) is not None]
    bodies = []
    for section in made:
        template = environment.from_string(section.template.read_text(encoding="utf-8"))
        bodies.append(Markup(template.render(**section.content)))  # noqa: S704  (it is escaped)
    page = environment.get_template("page.html.j2")
    return page.render(sections=list(zip(made, bodies, strict=True)))
