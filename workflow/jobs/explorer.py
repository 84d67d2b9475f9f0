"""Make the explorer of the study: the page that runs the engines."""

from pathlib import Path

from model.runs.in_browser import modules
from model.show.explorer.content import study_model
from model.show.explorer.page import build_page
from model.study.config import Study
from model.tracking.provenance import write_text


def run(study: Study, maps: list[Path], refined: list[Path], page: Path) -> None:
    """Write the page with the figures' ``maps`` and the ``refined`` ones, in the order of MAPS."""
    made = modules()
    write_text(
        build_page(study_model(study, made.interface, [*zip(maps, refined, strict=True)]), made),
        page,
    )
