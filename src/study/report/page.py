"""The page: its sections in order; background and tables are folded."""

from collections.abc import Callable, Sequence
from pathlib import Path

from markupsafe import Markup

from study.report import answer, background, figures, findings, ledger
from study.report.section import Results, Section, subscripts
from vibralign.plots.style import FORMATS
from vibralign.plots.templates import templates
from vibralign.plots.words import number, percent, power, short

Make = Callable[[Results], Section]

# In the order of the page.
FINDINGS: tuple[Make, ...] = (
    answer.section,
    figures.section,
    findings.vibration,
    ledger.section,
    findings.jamming,
)


def render_report(results: Results, more: Sequence[Make] = ()) -> str:
    """Return the page as HTML; the same inputs give the same text.

    The sections of ``more``, from outside the package, stand between findings and background.

    Links to datasets (``data/fig06.nc``) and figures (``figures/fig06.svg``) are relative to the
    results root, where the page belongs.
    """
    environment = templates(Path(__file__).parent)
    environment.filters.update(
        number=number, power=power, percent=percent, short=short, subscripts=subscripts
    )
    environment.globals["formats"] = FORMATS
    sections = []
    for make in (*FINDINGS, *more, background.section):
        section = make(results)
        template = environment.from_string(section.template.read_text(encoding="utf-8"))
        body = Markup(template.render(**section.content))  # noqa: S704  (it is escaped)
        sections.append((section, body))
    return environment.get_template("page.html.j2").render(sections=sections)
