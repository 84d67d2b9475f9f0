"""The record never looks away: results that are not what their records say stop the build."""

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from model.sweeps.files import write_json
from study.__main__ import main
from study.config import ConfigError, check_study, read_study, study_path
from study.tracking import TrackingError
from study.tracking.history import find, load_history, load_runs
from study.tracking.records import file_hash, named, records


def forge(root: Path) -> None:
    """Double the times of Fig. 7, which is as old as before, and remove its picture."""
    path = root / "data/fig07.nc"
    times = path.stat().st_atime_ns, path.stat().st_mtime_ns
    with xr.open_dataset(path) as stored:
        forged = stored.load()
    forged["tau_align"] *= 2.0
    forged.to_netcdf(path)
    os.utime(path, ns=times)
    (root / "figures/fig07.png").unlink()


def forge_with_record(root: Path) -> None:
    forge(root)
    (root / "data/fig07.run.json").unlink()


def forge_both(root: Path) -> None:
    """The record is forged, too; the claims were judged by other numbers."""
    forge(root)
    record = root / "data/fig07.run.json"
    times = record.stat().st_atime_ns, record.stat().st_mtime_ns
    stated = json.loads(record.read_text(encoding="utf-8"))
    stated["outputs"]["fig07.nc"] = file_hash(root / "data/fig07.nc")
    record.write_text(json.dumps(stated), encoding="utf-8")
    os.utime(record, ns=times)


def link_to_nothing(root: Path) -> None:
    forge(root)
    (root / ".#claims.csv").symlink_to("nobody@nowhere.1:1")  # the lock of an editor
    (root / "data/elsewhere").symlink_to("/nowhere")


def cut_off(root: Path) -> None:
    path = root / "data/chunks/fig13/1.nc"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def no_record_at_all(root: Path) -> None:
    (root / "data/fig07.run.json").write_text("{", encoding="utf-8")


def no_history(root: Path) -> None:
    """A history that takes no file, as on a full disk, whoever asks."""
    forge(root)
    shutil.rmtree(root / "history")
    (root / "history").write_text("no folder", encoding="utf-8")


SPOILT: dict[Callable[[Path], None], str] = {
    forge: "tiny/data/fig07.nc: is not the file that its job left",
    forge_with_record: "tiny/data/fig07.nc: has no record",
    forge_both: "tiny/claims.csv: was made from another tiny/data/fig07.nc",
    link_to_nothing: "tiny/data/fig07.nc: is not the file that its job left",
    cut_off: "tiny/data/chunks/fig13/1.nc: is not the file that its job left",
    no_record_at_all: "tiny/data/fig07.run.json: cannot be read as a record",
    no_history: "tiny/history",
}


@pytest.mark.parametrize("spoil", SPOILT, ids=[each.__name__ for each in SPOILT])
def test_results_that_are_not_what_their_records_say_stop_the_build(
    copy_of_built: Any, spoil: Callable[[Path], None]
) -> None:
    root = copy_of_built.folder / "tiny"
    spoil(root)
    kept = {path: path.read_bytes() for path in root.rglob("*.nc") if path.is_file()}
    run = copy_of_built.forked("--no-hooks")
    assert run.returncode != 0
    assert SPOILT[spoil] in run.stderr, run.stderr
    assert {path: path.read_bytes() for path in root.rglob("*.nc") if path.is_file()} == kept
    assert not (root / "figures/fig07.png").exists() or spoil not in (forge, link_to_nothing)
    if spoil not in (no_history, no_record_at_all):
        last = load_history(root)[-1]
        assert last["outcome"] == "failed"
        assert SPOILT[spoil] in last["reason"]


def test_what_was_refused_is_made_anew_when_it_is_deleted(copy_of_built: Any, built: Any) -> None:
    root = copy_of_built.folder / "tiny"
    forge(root)
    (root / "data/fig07.nc").unlink()
    run = copy_of_built.forked("fig07")
    assert run.returncode == 0, run.stdout + run.stderr
    files = "tiny/data/fig07.nc", "tiny/figures/fig07.png"
    assert copy_of_built.sha256(*files) == built.sha256(*files)


def test_results_of_another_configuration_are_found_whatever_snakemake_is_told(
    copy_of_built: Any, tiny: dict[str, Any]
) -> None:
    tiny["figures"]["fig07"]["held"] = {"frequency": 1.5}
    copy_of_built.configure(tiny)
    words = "tiny/data/fig07.nc: was made with another configuration"
    for options in (["--touch"], ["--rerun-triggers", "mtime"]):
        run = copy_of_built.forked("fig07", *options)
        assert run.returncode != 0
        assert words in run.stderr, run.stderr
    assert ("sweep", "tiny/data/fig07.nc") in copy_of_built.planned(), "nothing was touched"


def test_a_job_runs_in_a_start_only(copy_of_built: Any) -> None:
    """So that a Snakemake that no longer tells of its start cannot leave out the look."""
    snakefile = copy_of_built.folder / "Snakefile"
    text = snakefile.read_text(encoding="utf-8")
    text = text.replace("start = begin(workflow, root)", "").replace(
        "configure(start, ", "dict(study="
    )
    snakefile.write_text(text, encoding="utf-8")
    (copy_of_built.folder / "tiny/data/fig05.nc").unlink()
    run = copy_of_built.forked("tiny/data/fig05.nc")
    assert run.returncode != 0
    assert "sweep/fig05 refused: only a start of the study runs its jobs" in run.stdout + run.stderr


def test_the_order_of_starts_is_not_that_of_the_clock(copy_of_built: Any) -> None:
    root = copy_of_built.folder / "tiny"
    first = root / "history/1.json"
    record = json.loads(first.read_text(encoding="utf-8"))
    first.write_text(json.dumps(record | {"started": "2099-01-01T00:00:00.000+00:00"}), "utf-8")
    assert copy_of_built.forked("fig11").returncode == 0
    assert copy_of_built.forked("no_such_target").returncode != 0
    numbers = [
        (each["start"], each["outcome"], len(each["runs"]) > 0) for each in load_history(root)
    ]
    assert numbers == [(1, "done", True), (2, "done", False), (3, "failed", False)]
    assert find(root, "last")["start"] == 3
    assert "No rule to produce no_such_target" in load_history(root)[-1]["reason"]
    copy_of_built.dry_run("no_such_target")
    assert len(load_history(root)) == 3


@pytest.mark.parametrize("root", ["r1/", "~/x", ".", "a/../b", "a\nb", "{a}", "<a>", "", "..", "/"])
def test_a_results_root_that_means_two_things_is_refused_in_a_line(root: Any) -> None:
    stated = {**read_study(study_path()), "results_root": root}
    with pytest.raises(ConfigError) as refusal:
        check_study(stated)
    (line,) = str(refusal.value).splitlines()
    assert f"config: results_root = {root!r}: must be the plain path of a folder" in line


def test_a_refused_results_root_leaves_nothing_behind(workspace: Any, tiny: dict[str, Any]) -> None:
    workspace.configure({**tiny, "results_root": "~/x\n{a}/"})
    before = {path.name for path in workspace.folder.iterdir()}
    run = workspace.dry_run()
    assert run.returncode != 0
    told = [line for line in (run.stdout + run.stderr).splitlines() if "results_root = " in line]
    assert len(told) == 1
    assert {path.name for path in workspace.folder.iterdir()} - {".snakemake"} == before


def test_a_module_is_refused_in_a_line(workspace: Any) -> None:
    outer = workspace.folder / "outer.smk"
    outer.write_text(
        'module study:\n    snakefile: "Snakefile"\n    config: config\n\nuse rule * from study\n',
        encoding="utf-8",
    )
    run = workspace.dry_run("--snakefile", "outer.smk")
    assert run.returncode != 0
    told = [line for line in (run.stdout + run.stderr).splitlines() if "vibralign" in line]
    assert len(told) == 1, run.stdout
    assert "vibralign's study is no module" in told[0]


# --- What is kept of starts and runs ------------------------------------------------------------


@pytest.fixture
def kept(results: Path, tmp_path: Path) -> Path:
    """A copy of the results alone."""
    return shutil.copytree(results, tmp_path / "results")


def add_start(root: Path, runs: dict[str, dict[str, str]], outcome: str = "running") -> None:
    """Add a start with records of runs; where it is still "running" it was killed."""
    number = len(load_history(root)) + 1
    began = {"start": number, "started": "2026-01-01T00:00:00.000+00:00", "git": {}}
    path = root / f"history/{number}.json"
    path.write_text(json.dumps({**began, "outcome": outcome, "command": []}), encoding="utf-8")
    for run, ended in runs.items():
        write_json({**named(run), **began, **ended}, root / f"history/{number}/{run}.json")


def test_every_run_is_recorded_with_what_it_was_made_from(results: Path) -> None:
    (start,) = load_history(results)
    assert start["outcome"] == "done"
    assert start["failures"] == []
    runs = {each["run"]: each for each in load_runs(results)}
    assert runs.keys() == {each["run"] for each in start["runs"]}
    merged = runs["merge/fig13"]
    assert merged["inputs"].keys() == {f"chunks/fig13/{number}.nc" for number in range(3)}
    assert merged["outputs"] == {"fig13.nc": file_hash(results / "data/fig13.nc")}
    held = read_study(study_path())["figures"]["fig13"]["held"]
    assert merged["parameters"].items() >= held.items()
    assert {"config_hash", "stated", "code", "versions", "git"} <= merged.keys()
    assert (merged["start"], merged["current"], merged["status"]) == (1, True, "done")


def test_jobs_that_failed_and_jobs_that_were_killed_are_told_apart(kept: Path) -> None:
    failed = {"status": "failed", "reason": "ValueError: no such colour"}
    add_start(kept, {"plot/fig06": failed, "kernels": {"status": "running"},
                     "chunk/fig13/0": {"status": "interrupted", "reason": "Ctrl-C"}})  # fmt: skip
    runs = {each["run"]: each for each in load_runs(kept) if each["start"] == 2}
    assert {run: each["status"] for run, each in runs.items()} == {
        "plot/fig06": "failed", "kernels": "interrupted", "chunk/fig13/0": "interrupted",
    }  # fmt: skip
    assert runs["plot/fig06"]["reason"] == "ValueError: no such colour"
    assert "was killed" in runs["kernels"]["reason"]
    assert all(each["current"] for each in runs.values())
    first = find(kept, "plot/fig06@1")
    assert (first["status"], first["current"]) == ("done", False)
    assert load_history(kept)[-1]["outcome"] == "interrupted"


def test_what_a_job_raises_is_in_its_record(copy_of_built: Any) -> None:
    script = copy_of_built.folder / "workflow/scripts/plot.py"
    text = script.read_text(encoding="utf-8")
    script.write_text(text.replace("    dataset =", "    1 / 0\n    dataset ="), encoding="utf-8")
    run = copy_of_built.forked("tiny/figures/fig06.png")
    words = "ZeroDivisionError: division by zero"
    assert f"plot/fig06 failed: {words} (tiny/logs/plot/fig06.log)" in run.stderr
    last = load_history(copy_of_built.folder / "tiny")[-1]
    assert last["outcome"] == "failed"
    assert [(each["run"], each["reason"]) for each in last["failures"]] == [("plot/fig06", words)]


def test_results_behind_links_are_read(kept: Path, tmp_path: Path) -> None:
    names = {each["run"] for each in records(kept)}
    shutil.move(kept / "data", tmp_path / "disk")
    (kept / "data").symlink_to(tmp_path / "disk")
    assert {each["run"] for each in records(kept)} == names


def test_names_that_nothing_has_are_refused(results: Path, tmp_path: Path) -> None:
    with pytest.raises(TrackingError, match="holds no history"):
        load_history(tmp_path)
    for name in ("7", "merge/fig99", "merge/fig13@7"):
        with pytest.raises(TrackingError, match=f"'{name}' is neither a run nor a start"):
            find(results, name)


@pytest.mark.parametrize(
    ("run", "figure"),
    [("chunk/fig06/0", "fig06"), ("plot/fig13_vibration", "fig13"), ("kernels", None),
     ("sweep/fig13_round", "fig13_round")],
)  # fmt: skip
def test_a_run_is_named_with_its_rule_and_figure(run: str, figure: str | None) -> None:
    assert named(run) == {"run": run, "rule": run.split("/", 1)[0], "figure": figure}


# --- Two results folders ------------------------------------------------------------------------


def diff(capsys: Any, *arguments: str, code: int) -> Any:
    assert main(["diff", *arguments, "--json"]) == code
    return json.loads(capsys.readouterr().out)


def test_a_build_is_equal_to_its_copy(capsys: Any, results: Path, kept: Path) -> None:
    found = diff(capsys, str(results), str(kept), code=0)
    assert found["not_compared"] == found["data"] == found["claims"] == []


def changed(path: Path, change: Callable[[xr.Dataset], xr.Dataset]) -> None:
    with xr.open_dataset(path, decode_timedelta=False) as stored:
        dataset = stored.load()
    change(dataset).to_netcdf(path)


def test_differences_of_every_kind_are_found(capsys: Any, results: Path, kept: Path) -> None:
    def shift(dataset: xr.Dataset) -> xr.Dataset:
        dataset["tau_align"][1, 2] += 0.5
        return dataset

    changed(kept / "data/fig11.nc", shift)
    changed(kept / "data/fig07.nc", lambda dataset: dataset.isel(friction=slice(1, None)))
    changed(kept / "data/fig08.nc", lambda dataset: dataset.isel(frequency=0))
    changed(kept / "data/fig09.nc", lambda dataset: dataset.assign_attrs(title="another"))
    (kept / "data/fig10.nc").unlink()
    for path in (kept / "data").glob("*.nc"):  # datasets that are no figures
        if "outcome" not in xr.open_dataset(path):
            changed(path, lambda dataset: dataset.isel({next(iter(dataset.dims)): slice(1)}))
    found = diff(capsys, str(results), str(kept), code=1)
    (change,) = [each for each in found["data"] if each["figure"] == "fig11"]
    assert (change["variable"], change["differing"]) == ("tau_align", 1)
    assert change["largest"] == pytest.approx(0.5)
    assert change["at"].keys() == {"friction", "clearance"}
    said = "\n".join(found["not_compared"])
    assert "fig08: the two vary different parameters" in said
    assert "fig10.nc: only in " in said
    assert f"claims.csv: not judged since {kept}/data/" in said
    assert found["claims"] is None
    assert any(
        each.startswith("data/fig09.nc:") and "title" in each for each in found["other_data"]
    )


def test_a_trajectory_is_compared_away_from_its_jumps() -> None:
    """A jump that is 1e-9 later is no change of 1; a variable that is 1e-3 higher has changed."""
    from study.tracking.compare import change_of, common_points  # noqa: PLC0415

    def course(jump: float, offset: float, steps: int) -> xr.Dataset:
        before, after = np.linspace(0.0, jump, steps), np.linspace(jump, 2.0, steps)
        force = np.concatenate([np.ones(steps), np.zeros(steps)]) + offset
        time = np.concatenate([before, after])
        return xr.Dataset({"force": ("sample", force)}, {"time": ("sample", time)})

    def largest(after: xr.Dataset) -> float:
        pair = common_points(course(1.0, 0.0, 11), after)
        change = change_of(*(each["force"] for each in pair), figure="fig05")
        assert set(change.at) == {"time"}
        return change.largest

    assert largest(course(1.0 + 1e-9, 0.0, 14)) == 0.0
    assert largest(course(1.0 + 1e-9, 1e-3, 14)) == pytest.approx(1e-3)
