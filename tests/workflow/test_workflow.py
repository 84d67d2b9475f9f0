"""The workflow: what it refuses, what is a target, and that the same study gives the same bytes."""

from pathlib import Path
from typing import Any

import pytest

from study.tracking.history import load_history, load_runs
from study.tracking.records import records


def test_a_fault_in_the_configuration_stops_before_anything_is_made(
    workspace: Any, tiny: dict[str, Any]
) -> None:
    workspace.configure({**tiny, "structure": {"inertia": -1.0}})
    run = workspace.dry_run()
    assert run.returncode != 0
    assert "structure.inertia = -1.0: must be a finite number > 0" in run.stdout + run.stderr
    assert not (workspace.folder / "tiny").exists()


def test_a_refused_configuration_is_recorded_with_the_rule_that_it_breaks(
    workspace: Any, tiny: dict[str, Any]
) -> None:
    workspace.configure({**tiny, "operating_point": {"friction": -0.1}})
    assert workspace.forked().returncode == 1
    (record,) = load_history(workspace.folder / "tiny")
    assert (record["outcome"], record["runs"], record["failures"]) == ("failed", [], [])
    assert "friction = -0.1: must be a finite number >= 0" in record["reason"]
    workspace.configure({**tiny, "results_root": 7})  # which would be the place of the record
    assert workspace.forked().returncode == 1
    (record,) = load_history(workspace.folder / "results")
    assert "results_root = 7" in record["reason"]


@pytest.mark.parametrize("text", ["settings: {horizon: 300, horizon: 30}", "{a: 0300}"])
def test_a_file_that_may_mean_two_things_is_refused(workspace: Any, text: str) -> None:
    (workspace.folder / "config/tiny.yaml").write_text(text, encoding="utf-8")
    run = workspace.forked("-n")
    assert run.returncode != 0
    assert "tiny.yaml: cannot be read as YAML: line 1" in run.stdout + run.stderr


def test_one_figure_is_a_target(workspace: Any) -> None:
    run = workspace.dry_run("fig11")
    assert run.returncode == 0, run.stderr
    planned = run.stdout + run.stderr
    for rule in ("sweep", "plot", "fig11"):
        assert rule in planned
    for rule in ("report", "schematic", "fig12"):
        assert rule not in planned


def test_an_edit_below_every_job_leaves_none_of_them_out(copy_of_built: Any) -> None:
    """Also if another result is missing and the kernels are compiled anew."""
    for script in copy_of_built.folder.glob("workflow/scripts/*.py"):
        text = script.read_text(encoding="utf-8")
        script.write_text(f"{text}\nEDITED = True\n", encoding="utf-8")
    (copy_of_built.folder / "tiny/data/fig05.nc").unlink()
    edited = copy_of_built.dry_run(*copy_of_built.DATA, *copy_of_built.BESIDE)
    counts = dict(line.split() for line in edited.stdout.splitlines() if len(line.split()) == 2)
    jobs = ("kernels", "sweep", "chunk", "merge", "precision")
    assert set(jobs) <= set(counts), edited.stdout
    assert int(counts["chunk"]) == 3


def test_accuracy_prints_what_it_found_whether_or_not_it_computes(workspace: Any) -> None:
    run = workspace.forked("accuracy")
    assert run.returncode == 0, run.stdout + run.stderr
    root = workspace.folder / "tiny"
    found = (root / "accuracy/summary.txt").read_text(encoding="utf-8")
    assert "error below tau_error" in found
    assert found in run.stdout
    assert {each["run"] for each in load_runs(root)} == {
        "kernels",
        "trial/error/0",
        "trial/error/1",
        "trial/settled/0",
        "trial_summary",
    }
    again = workspace.forked("accuracy")
    assert found in again.stdout
    assert "trying chunk" not in again.stdout + again.stderr


def test_fuzz_with_more_sets_tries_only_the_further_ones(copy_of_built: Any) -> None:
    more = ("--config", 'accuracy={"fuzz": {"sets": 7}}')
    run = copy_of_built.forked("fuzz")
    assert run.returncode == 0, run.stdout + run.stderr
    assert "5 sets of seed 2007" in run.stdout
    assert run.stdout.splitlines().count("every property holds") == 1
    dry = copy_of_built.dry_run("fuzz", *more)
    # Of parts of two sets, the third had one of its two; the fourth is new.
    assert "fuzz_part 2" in " ".join(dry.stdout.split()), dry.stdout + dry.stderr


THREADED = ("sweep", "merge", "cases", "claims", "plot")


def build_whole(made: Any, cores: int, first: str | None) -> list[str]:
    """Build the whole study, one figure ``first``; return the runs in order of time.

    Jobs get as many threads for numerical libraries as there are cores.
    """
    threads = ["--set-threads", *(f"{rule}={cores}" for rule in THREADED)]
    for targets in ([first], []) if first else ([],):
        run = made.snakemake(*targets, *threads, cores=cores)
        assert run.returncode == 0, run.stdout + run.stderr
    runs = sorted(records(made.folder / "tiny"), key=lambda each: each["started"])
    return [each["run"] for each in runs]


@pytest.mark.nightly
def test_the_whole_study_has_the_same_bytes_in_another_folder(
    tmp_path: Path, make_workspace: Any, built_twice: dict[str, Any]
) -> None:
    """Datasets, pictures, claims and report of two builds, at one and at two cores.

    The second build starts with the last figure of the first, and its jobs have two threads.
    `make nightly` builds the smoke study, with STUDY=full the whole one. CPU times differ between
    builds: they are copied from one to the other before pages that show them are compared.
    """
    builds: list[Any] = []
    orders: list[list[str]] = []
    for cores in (1, 2):
        made = make_workspace(tmp_path / f"with_{cores}")
        made.configure(built_twice)
        drawn = [Path(run).name for order in orders for run in order if "plot/" in run]
        orders.append(build_whole(made, cores, drawn[-1] if drawn else None))
        if builds:
            made.take_times(builds[0])
            assert made.snakemake(cores=cores).returncode == 0
        builds.append(made)
        assert "Nothing to be done" in made.dry_run().stdout
    assert orders[0] != orders[1]
    assert sorted(orders[0]) == sorted(orders[1])
    results = [made.results() for made in builds]
    assert results[0].items() ^ results[1].items() == set()
    print(f"{len(results[0])} files have the same bytes")  # noqa: T201  (`pytest -rP` shows it)
