"""Jobs that run again after an edit are exactly those that depend on it, by the real Snakemake.

Every case is one dry run, on a copy of the golden build. Each takes seconds: `make test` tries
five edits, `make nightly` all.
"""

import contextlib
import copy
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

PROJECT = Path(__file__).resolve().parents[2]

LAST = {"report"}
COMPARED = {"precision"}
METHODS = {*COMPARED, *LAST}
JUDGED = {"claims", *LAST}
DRAWN = {"plot", *JUDGED}
WEIGHED = {"cases", *LAST}
COMPUTED = {
    "sweep", "chunk", "merge", *METHODS, *DRAWN, *WEIGHED, "explorer",
}  # fmt: skip
STORED = COMPUTED - COMPARED - {"explorer"}  # what reads or writes datasets
KERNELS = {"kernels", "page_engines"}
EVERYTHING = {*KERNELS, "schematic", *COMPUTED}
PICTURES = {"schematic", "plot", *LAST}
EDIT = ("\nfrom ", "\nEDITED = True\nfrom ")

# (file, what stands there, what an edit puts there, the rules that must run again)
EDITS = [
    ("src/model/engine/step.py", *EDIT, {*KERNELS, *COMPUTED}),
    ("verification/bench/methods/package.py", *EDIT, METHODS),
    ("src/study/claims/claims.yaml", "the regime is non-impact", "contact is kept",
     {"cases", *JUDGED}),
    ("src/vibralign/plots/maps.py", "_SPREAD_FOR_LOG = 8.0", "_SPREAD_FOR_LOG = 9.0",
     {"plot", *LAST}),
    ("requirements.lock", "numpy==", "numpy==9.", EVERYTHING),
]  # fmt: skip
MORE_EDITS = [
    ("src/model/sweeps/io.py", '"complevel": 4', '"complevel": 5', STORED),
    ("workflow/scripts/merge.py", *EDIT, {"merge", *DRAWN}),
    ("src/study/config/methods.py", "gt=0.0", "gt=1e-9",
     {*METHODS, "explorer", *WEIGHED}),
    ("src/study/config/accuracy.py", *EDIT, {"explorer", *WEIGHED}),
    ("src/model/sweeps/settings.py", *EDIT, COMPUTED),
    ("src/model/sweeps/files.py", "0o666", "0o660", EVERYTHING),
    ("src/model/sweeps/sweep.py", *EDIT, STORED),
    ("src/vibralign/plots/style.py", '"font.size": 9.0', '"font.size": 9.5', PICTURES),
    ("src/study/schematics/sheet.py", *EDIT, {"schematic", *LAST}),
    ("src/study/report/page.html.j2", "how safely", "how surely", LAST),
    ("src/study/report/ledger.html.j2", "no device shows", "none shows", LAST),
    ("src/vibralign/explorer/page.main.js", "CELLS = 65", "CELLS = 33", {"explorer", *LAST}),
    ("workflow/scripts/plot.py", *EDIT, {"plot", *LAST}),
]  # fmt: skip
# On which no job depends: a docstring, what records the jobs, commands, what has rules of its own.
OF_NO_JOB = [
    ("src/model/physics/forces.py", "the pressing force, downward", "other words"),
    ("src/vibralign/answers/leeways.py", *EDIT),
    ("src/study/tracking/records.py", *EDIT),
    ("src/vibralign/commands/main.py", *EDIT),
    ("verification/accuracy.py", "TIGHT = 1e-13", "TIGHT = 1e-12"),
]


def test_what_an_edit_replaces_stands_in_its_file() -> None:
    """Also of the edits that only `make nightly` tries."""
    edits = [each[:2] for each in (*EDITS, *MORE_EDITS, *OF_NO_JOB)]
    assert [each for each in edits if each[1] not in (PROJECT / each[0]).read_text("utf-8")] == []


@pytest.fixture(scope="module")
def project(built: Any, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A copy of the golden build, and of the package; all tests but the last leave it as it was."""
    made = copy.copy(built)
    made.folder = shutil.copytree(built.folder, tmp_path_factory.mktemp("edited") / "project")
    for part in ("src", "verification"):  # with their bytecode, if there is any
        shutil.copytree(PROJECT / part, made.folder / part)
    return made


def rules(planned: set[tuple[str, str]]) -> set[str]:
    return {rule for rule, _ in planned}


@contextlib.contextmanager
def edited(project: Any, file: str, old: str, new: str) -> Iterator[None]:
    path = project.folder / file
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    project.checkout = project.folder  # an unedited package is loaded already
    try:
        yield
    finally:
        path.write_text(text, encoding="utf-8")
        project.checkout = PROJECT


@pytest.mark.parametrize(
    ("file", "old", "new", "expected"),
    [*EDITS, *(pytest.param(*each, marks=pytest.mark.nightly) for each in MORE_EDITS)],
    ids=[each[0] for each in (*EDITS, *MORE_EDITS)],
)
def test_an_edit_runs_again_what_depends_on_it_and_nothing_else(
    project: Any, file: str, old: str, new: str, expected: set[str]
) -> None:
    with edited(project, file, old, new):
        assert rules(project.planned()) == expected


def test_no_job_runs_again_after_edits_on_which_none_depends(project: Any) -> None:
    with contextlib.ExitStack() as edits:
        for each in OF_NO_JOB:
            edits.enter_context(edited(project, *each))
        assert project.planned() == set()


@pytest.mark.parametrize(
    "edit",
    [("src/study/claims/claims.yaml", "most: 0.25", "most: 0.2"),
     ("src/model/physics/forces.py", "return -p.press_force", "return -1.01 * p.press_force")],
    ids=["limit", "equation"],
)  # fmt: skip
def test_another_limit_or_equation_stops_the_build_with_the_command_that_mends_it(
    project: Any, edit: tuple[str, str, str]
) -> None:
    with edited(project, *edit):
        run = project.dry_run()
    assert run.returncode != 0
    assert "draw the random devices anew: make null" in run.stdout + run.stderr


@pytest.mark.nightly
def test_the_reason_of_a_rerun_names_the_file(project: Any) -> None:
    with edited(project, "workflow/scripts/plot.py", *EDIT):
        run = project.dry_run("tiny/figures/fig11.png", "--quiet", "host")
    (reason,) = [line for line in run.stdout.splitlines() if "Params have changed" in line]
    before, now = (re.findall(rf"{when}: '(\S+) \w+'", reason) for when in ("before", "now"))
    assert before == now == ["workflow/scripts/plot.py"]


# A part of the configuration, and the rules that must run again
STATED = [
    # Maps mark where other figures stand: they are drawn anew, and not computed.
    ({"figures": {"fig11": {"held": {"press_force": 2.6}}}},
     {"sweep", "explorer", *DRAWN, *WEIGHED}),
    # Words stand on the two pages, and in no dataset.
    ({"figures": {"fig11": {"title": "Another title"}}}, {"explorer", *LAST}),
    ({"figures": {"fig11": {"caption": "Another caption."}}}, {"explorer", *LAST}),
    ({"figures": {"fig13": {"caption": "Another caption."}}}, {"explorer", *LAST}),
    ({"figures": {"fig13": {"chunks": 2}}}, {"chunk", "merge", "explorer", *DRAWN}),
    ({"settings": {"tolerance": 1e-9}}, COMPUTED),
]  # fmt: skip
OF_ALL = {"explorer", "claims", *WEIGHED}


@pytest.mark.nightly
@pytest.mark.parametrize(("stated", "expected"), STATED, ids=[str(each[0]) for each in STATED])
def test_a_change_of_the_configuration_runs_again_what_it_is_about(
    project: Any, tiny: dict[str, Any], stated: dict[str, Any], expected: set[str]
) -> None:
    def lay(over: dict[str, Any], under: dict[str, Any]) -> None:
        for name, value in over.items():
            if isinstance(value, dict):
                lay(value, under.setdefault(name, {}))
            else:
                under[name] = value

    before = copy.deepcopy(tiny)
    lay(stated, tiny)
    project.configure(tiny)
    planned = project.planned()
    project.configure(before)
    assert rules(planned) == expected
    if figures := stated.get("figures"):
        (figure,) = figures
        others = {output for rule, output in planned if figure not in output}
        own = {output for rule, output in planned if rule in OF_ALL or rule == "plot"}
        assert others <= own


@pytest.mark.nightly
def test_a_lost_file_is_made_again(project: Any) -> None:
    lost = project.folder / "tiny/figures/fig07.svg"
    kept = lost.rename(lost.with_suffix(".kept"))
    planned = project.planned()
    kept.rename(lost)
    assert rules(planned) == {"plot", *LAST}
    assert all("fig07" in output or rule in LAST for rule, output in planned)


def test_nothing_runs_again_after_touch_comment_and_reformat(project: Any) -> None:
    project.checkout = project.folder
    places = ("src", "verification", "workflow")
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
