"""Render the report: one page with every figure, its caption, parameters and outcomes."""

from pathlib import Path

from benchmarks.report import SECTIONS
from model.show.report.page import render_report
from model.show.report.section import Results
from model.study.config import Study
from model.tracking.provenance import write_text


def run(study: Study, root: Path, files: list[Path], page: Path) -> None:
    """Write the page from ``files`` below ``root``.

    Raises:
        ValueError: a section reads a file that the rule does not state.
    """
    results = Results(root, study, live=True)
    text = render_report(results, SECTIONS)
    unstated = set(results.inputs) - {*files}
    if unstated:
        raise ValueError(f"not an input of the rule: {', '.join(map(str, sorted(unstated)))}")
    write_text(text, page)
