"""Jobs that run again after an edit are exactly those that depend on it, by the real Snakemake.

The outputs are empty files that Snakemake takes for made, so that every case is one dry run.
"""

import copy
import os
import shutil
from pathlib import Path
from typing import Any

import pytest

PROJECT = Path(__file__).resolve().parents[2]

LAST = {"report", "index"}
HARD = {"draw_stability", "draw_stiffness"}
BESIDE = {"draw_evaluations", "draw_times", "draw_wrong_points"}  # speed against error
JUDGED = {"claims", *LAST}
DRAWN = {"plot", *JUDGED}
FIXED = {"fixed_steps", "draw_wrong_points"}
MAPPED = {"map_part", "map", "draw_vibration"}
OWN_RUNS = {"claims_runs", "draw_claims"}  # of the claims ledger
JAMMING = {"jamming", "draw_jamming"}
COMPUTED = {
    "chunk", "history", "merge", "precision", "fixed_steps", *MAPPED, *OWN_RUNS,
    *JAMMING, "hard_cases", *DRAWN, *BESIDE, *HARD, "explorer",
}  # fmt: skip
KERNELS = {"kernels", "unlocated_kernels", "page_engines"}
EVERYTHING = {*KERNELS, "schematic", *COMPUTED}

# (file, what stands there, what a mutation puts there, the rules that must run again)
MUTATIONS = [
    ("src/model/physics/forces.py", "return -p.press_force", "return -1.01 * p.press_force",
     {*KERNELS, *COMPUTED}),
    ("src/model/physics/geometry.py", "return ", "return 1.0 * ", EVERYTHING),
    ("src/model/study/files.py", "0o644", "0o640", EVERYTHING),
    ("src/model/study/datasets.py", '"complevel": 4', '"complevel": 5',
     COMPUTED),
    ("src/model/show/areas.py", "_SPREAD_FOR_LOG = 8.0", "_SPREAD_FOR_LOG = 9.0",
     {"plot", "draw_vibration", *LAST}),
    ("src/model/show/style.py", '"font.size": 9.0', '"font.size": 9.5',
     {"schematic", "plot", "draw_vibration", "draw_claims", "draw_jamming", *LAST,
      *BESIDE, *HARD}),
    ("src/model/show/schematics/sheet.py", "import ", "import math as _unused\nimport ",
     {"schematic", *LAST}),
    ("src/model/show/report/page.html.j2", "how safely", "how surely", LAST),
    ("src/model/show/explorer/page.main.js", "CELLS = 65", "CELLS = 33", {"explorer", *LAST}),
    ("src/model/tracking/records.py", '_NO_RUNS = {"index"', '_NO_RUNS = {"indices"', {"index"}),
    ("benchmarks/methods/by_hand.py", "import ", "import math as _unused\nimport ",
     {"unlocated_kernels", "precision", "fixed_steps", "hard_cases", *BESIDE, *HARD, *LAST}),
    ("verification/accuracy.py", "TIGHT = 1e-13", "TIGHT = 1e-12", set()),
    ("src/model/cli/main.py", "import ", "import math as _unused\nimport ", set()),
    ("workflow/jobs/merge.py", "import ", "import math as _unused\nimport ",
     {"merge", *FIXED, *DRAWN, "explorer"}),
    ("src/model/study/maps.py", "PERIODS = 0.4", "PERIODS = 0.5",
     {*MAPPED, "plot", "explorer", *LAST}),
    ("workflow/jobs/plot.py", "import ", "import math as _unused\nimport ",
     {"plot", *LAST}),
    ("src/model/study/claims/claims.yaml", "least: 0.8", "least: 0.7",
     JUDGED),
    ("src/model/study/claims/runs.py", "_STATIC = 1.0", "_STATIC = 2.0",
     {*OWN_RUNS, *JUDGED}),
    ("src/model/show/report/claims.html.j2", "Thresholds", "on trial", LAST),
    ("requirements.lock", "numpy==", "numpy==9.", EVERYTHING),
]  # fmt: skip


@pytest.fixture
def project(touched: Any, tmp_path: Path) -> Any:
    """A copy of the made study, and of the package, that a test may edit."""
    made = copy.copy(touched)
    made.folder = shutil.copytree(touched.folder, tmp_path / "project")
    ignored = shutil.ignore_patterns("__pycache__")
    for part in ("src", "verification", "benchmarks"):
        shutil.copytree(PROJECT / part, made.folder / part, ignore=ignored)
    made.checkout = made.folder
    return made


def rules(planned: set[tuple[str, str]]) -> set[str]:
    return {rule for rule, _ in planned}


def test_nothing_runs_again_after_touch_comment_and_reformat(project: Any) -> None:
    places = ("src", "verification", "benchmarks", "workflow")
    sources = [path for place in places for path in (project.folder / place).rglob("*.py")]
    assert len(sources) > 100
    for path in sources:
        text = path.read_text(encoding="utf-8")
        text = text.replace("\n\n\n", "\n\n\n# a comment\n\n\n").replace(
            "\n    return ", "\n\n    return "
        )
        path.write_text(f"{text}\n# the end\n", encoding="utf-8")
        os.utime(path)
    forces = project.folder / "src/model/physics/forces.py"
    reformatted = "return -(\n        p.press_force\n    )"
    text = forces.read_text(encoding="utf-8")
    assert "return -p.press_force" in text
    forces.write_text(text.replace("return -p.press_force", reformatted), encoding="utf-8")
    assert project.planned() == set()


@pytest.mark.parametrize(
    ("file", "old", "new", "expected"), MUTATIONS, ids=[each[0] for each in MUTATIONS]
)
def test_an_edit_runs_again_what_depends_on_it_and_nothing_else(
    project: Any, file: str, old: str, new: str, expected: set[str]
) -> None:
    path = project.folder / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert rules(project.planned()) == expected


def test_a_change_of_one_figure_runs_only_that_figure(project: Any, tiny: dict[str, Any]) -> None:
    tiny["figures"]["fig11"]["held"] = {"press_force": 2.6}
    project.configure(tiny)
    planned = project.planned()
    # Maps mark where other figures stand: they are assembled anew, and not computed.
    marked = {"map", "draw_vibration", "plot", "explorer", *JUDGED}
    assert rules(planned) == {"chunk", "merge", *marked}
    assert all("fig11" in output or rule in marked for rule, output in planned)


def test_a_caption_computes_nothing(project: Any, tiny: dict[str, Any]) -> None:
    tiny["figures"]["fig11"]["title"] = "Another title"
    project.configure(tiny)
    planned = project.planned()
    assert rules(planned) == {"merge", "explorer", *DRAWN}
    of_all = {"explorer", *JUDGED}
    assert all("fig11" in output or rule in of_all for rule, output in planned)


def test_another_number_of_chunks_computes_that_figure_anew(
    project: Any, tiny: dict[str, Any]
) -> None:
    tiny["figures"]["fig13"]["chunks"] = 2
    project.configure(tiny)
    planned = project.planned()
    # Its picture is that of its refined map, with the figure's own points that do not go in.
    assert rules(planned) == {"chunk", "merge", "explorer", *FIXED, *DRAWN}
    of_all = {"draw_wrong_points", "explorer", *JUDGED}
    assert all("fig13" in output or rule in of_all for rule, output in planned)


def test_a_setting_of_all_figures_computes_everything(project: Any, tiny: dict[str, Any]) -> None:
    tiny["settings"] = {"tolerance": 1e-9}
    project.configure(tiny)
    assert rules(project.planned()) == COMPUTED


def test_a_run_of_the_ledger_runs_the_ledger_only(project: Any, tiny: dict[str, Any]) -> None:
    tiny["claims_runs"]["rubbing"]["held"] = {"frequency": 0.6}
    project.configure(tiny)
    assert rules(project.planned()) == {*OWN_RUNS, "explorer", *JUDGED}


def test_a_lost_file_is_made_again(project: Any) -> None:
    (project.folder / "tiny/figures/fig07.svg").unlink()
    planned = project.planned()
    assert rules(planned) == {"plot", *LAST}
    assert all("fig07" in output or rule in JUDGED for rule, output in planned)
