"""The history: it contains all invocations and runs, however they ended."""

import csv
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from study.tracking import TrackingError
from study.tracking.history import (
    COLUMNS,
    end_the_future,
    find_invocation,
    find_run,
    is_running,
    load_history,
    load_runs,
    set_aside_damaged,
    sidecars,
    write_index,
)
from study.tracking.invocation import Invocation
from study.tracking.job import named


def test_a_run_and_its_invocation_are_recorded(recorded) -> None:
    invocation = recorded.invocation()
    recorded.merge()
    recorded.log("precision/fig06", "a log of a job that leaves no sidecar")
    assert invocation.end("done") == []
    (record,) = load_history(recorded.root)
    assert record["outcome"] == "done"
    assert record["wall_seconds"] >= 0.0
    (run,) = load_runs(recorded.root)
    assert run["run"] == "merge/fig06"
    assert run["invocation"] == record["invocation"] == invocation.name
    assert (run["status"], run["current"], run["counts"]["aligned"]) == ("done", True, 3)
    assert len(run["outputs"]["fig06.nc"]) == 64


def test_a_failed_run_is_recorded_with_the_last_line_of_its_log(recorded) -> None:
    invocation = recorded.invocation()
    recorded.merge(figure="fig07")
    recorded.fail("merge/fig06", "Traceback …\nDatasetError: a chunk is of another sweep\n")
    (told,) = invocation.end("failed")
    assert told.startswith("merge/fig06 failed: DatasetError: a chunk is of another sweep (")
    assert told.endswith("logs/merge/fig06.log)")
    failed, done = sorted(load_runs(recorded.root), key=lambda run: run["run"])
    assert (failed["status"], failed["figure"], failed["current"]) == ("failed", "fig06", True)
    assert done["status"] == "done"
    assert load_history(recorded.root)[0]["outcome"] == "failed"


def test_a_failure_that_was_mended_stays_in_the_history_and_is_not_current(recorded) -> None:
    with recorded.invoked("failed"):
        recorded.fail("merge/fig06", "MemoryError\n")
    recorded.built()
    runs = sorted((run["status"], run["current"]) for run in load_runs(recorded.root))
    assert runs == [("done", True), ("failed", False)]
    assert [each["outcome"] for each in load_history(recorded.root)] == ["failed", "done"]


@pytest.mark.parametrize("log", ["", "KeyboardInterrupt\n"])
def test_a_job_that_was_killed_is_interrupted_not_failed(recorded, log: str) -> None:
    with recorded.invoked("failed"):
        recorded.fail("chunk/fig06/0", log)
    (run,) = load_runs(recorded.root)
    assert run["status"] == "interrupted"
    assert "killed" in run["reason"]
    assert load_history(recorded.root)[0]["outcome"] == "interrupted"


def test_a_full_disk_leaves_no_word_and_is_named(recorded, monkeypatch) -> None:
    usage = shutil.disk_usage(recorded.root.parent)._replace(free=12_345)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    invocation = recorded.invocation()
    recorded.fail("chunk/fig06/0", "")
    (told,) = invocation.end("failed")
    assert "failed: ended without a message, with 12 kB left on the disk" in told


def test_logs_of_an_earlier_invocation_are_no_failures_of_this_one(recorded) -> None:
    recorded.log("chunk/fig06/0")
    os.utime(recorded.root / "logs/chunk/fig06/0.log", (1.0, 1.0))
    assert recorded.invocation().end("failed") == []
    assert load_runs(recorded.root) == []


def test_an_invocation_that_was_killed_is_interrupted_from_then_on(recorded) -> None:
    code = f"""
    import os, signal
    from pathlib import Path
    from study.tracking.invocation import Invocation
    root = Path({str(recorded.root)!r})
    Invocation(root).record()
    (root / "logs/chunk/fig06").mkdir(parents=True)
    (root / "logs/chunk/fig06/0.log").write_text("")
    os.kill(os.getpid(), signal.SIGKILL)
    """
    run = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=False)
    assert run.returncode == -signal.SIGKILL
    (record,) = load_history(recorded.root)
    assert record["outcome"] == "interrupted"
    assert [each["run"] for each in record["failures"]] == ["chunk/fig06/0"]
    stored = next((recorded.root / "history").glob("*.json")).read_text(encoding="utf-8")
    assert '"running"' in stored, "reading writes nothing"
    recorded.invocation().end("done")
    assert [each["outcome"] for each in load_history(recorded.root)] == ["interrupted", "done"]
    assert not list((recorded.root / "history").glob("*.lock"))


def test_an_invocation_that_lives_is_running(recorded) -> None:
    invocation = recorded.invocation()
    assert load_history(recorded.root)[0]["outcome"] == "running"
    other = Invocation(recorded.root)
    other.record()
    assert load_history(recorded.root)[0]["outcome"] == "running", "nobody else ends it"
    invocation.end("done")
    other.end("done")
    assert [each["outcome"] for each in load_history(recorded.root)] == ["done", "done"]


def test_a_disk_that_refuses_hides_nothing(recorded, capsys, monkeypatch) -> None:
    invocation = recorded.invocation()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("study.tracking.invocation.write_json", full)
    assert invocation.end("failed") == []
    assert "could not be recorded: [Errno 28] No space left" in capsys.readouterr().err


def test_the_index_has_a_line_for_every_run(recorded) -> None:
    with recorded.invoked("failed"):
        recorded.merge()
        recorded.fail("plot/fig06", "ValueError: no colour\n")
    write_index(recorded.root)
    with (recorded.root / "runs.csv").open(encoding="utf-8", newline="") as stream:
        rows = {row["run"]: row for row in csv.DictReader(stream)}
    assert tuple(rows["merge/fig06"]) == COLUMNS
    assert rows["merge/fig06"]["runs_aligned"] == "3"
    assert rows["plot/fig06"]["reason"] == "ValueError: no colour"


def test_runs_and_invocations_are_found_by_name(recorded) -> None:
    invocations = [recorded.built(shift) for shift in (0.0, 0.5)]
    runs, history = load_runs(recorded.root), load_history(recorded.root)
    first, last = (find_run(runs, f"merge/fig06@{each}") for each in invocations)
    assert first["outputs"] != last["outputs"]
    assert find_run(runs, "merge/fig06") == last
    assert find_invocation(history, "last")["invocation"] == invocations[1]
    assert find_invocation(history, invocations[0]) == history[0]
    with pytest.raises(TrackingError, match="is the beginning of 2"):
        find_invocation(history, "20")
    with pytest.raises(TrackingError, match="is no invocation"):
        find_invocation(history, "1999")
    with pytest.raises(TrackingError, match="is no run"):
        find_run(runs, "merge/fig99")


def test_a_root_without_history_and_a_broken_record_are_named(recorded, tmp_path: Path) -> None:
    with pytest.raises(TrackingError, match="holds no history"):
        load_history(tmp_path)
    recorded.merge()
    (recorded.root / "data/fig06.run.json").write_text("{", encoding="utf-8")
    with pytest.raises(TrackingError, match=r"fig06\.run\.json: cannot be read as a record"):
        sidecars(recorded.root)


def test_what_is_not_as_its_job_left_it_is_set_aside(recorded) -> None:
    for figure in ("fig06", "fig07", "fig08"):
        recorded.merge(figure=figure)
    data = recorded.root / "data"
    (data / "fig06.nc").write_bytes(b"half")
    (data / "fig08.run.json").write_text("{", encoding="utf-8")
    (data / ".fig09.nc-x1y2.part").write_bytes(b"half")
    deleted = {Path(name).name for name in set_aside_damaged(recorded.root, "now")}
    assert deleted == {"fig06.nc", "fig06.run.json", "fig08.run.json", ".fig09.nc-x1y2.part"}
    left = sorted(path.name for path in data.iterdir())
    assert left == ["fig07.nc", "fig07.run.json", "fig08.nc"]
    recorded.compare()
    assert set_aside_damaged(recorded.root, "now") == []
    times = recorded.root / "benchmarks/precision.csv"  # in another folder than its sidecar
    times.write_text("damaged", encoding="utf-8")
    assert len(set_aside_damaged(recorded.root, "now")) == 2
    assert not times.exists()
    assert {"precision.csv"} == {path.name for path in data.glob("precision*")}


@pytest.mark.parametrize(
    ("run", "figure"),
    [("chunk/fig06/0", "fig06"), ("plot/fig13_vibration", "fig13"), ("kernels", None)],
)
def test_a_run_is_named_with_its_rule_and_figure(run, figure):
    assert named(run) == {"run": run, "rule": run.split("/", 1)[0], "figure": figure}


def test_results_behind_a_link_are_checked_and_kept_aside(recorded, tmp_path: Path) -> None:
    recorded.merge()
    recorded.compare()
    shutil.move(recorded.root / "data", tmp_path / "disk")
    (recorded.root / "data").symlink_to(tmp_path / "disk")
    (tmp_path / "disk/around").symlink_to(tmp_path / "disk")  # a circle ends
    assert {each["run"] for each in sidecars(recorded.root).values()} == {
        "merge/fig06",
        "precision",
    }
    (tmp_path / "disk/fig06.nc").write_bytes(b"a forged one")
    times = recorded.root / "benchmarks/precision.csv"
    times.write_text("an edit", encoding="utf-8")
    assert len(set_aside_damaged(recorded.root, "now")) == 4
    assert not (tmp_path / "disk/fig06.nc").exists()
    kept = recorded.root / "history/now"
    assert (kept / "data/fig06.nc").read_bytes() == b"a forged one"
    assert (kept / "benchmarks/precision.csv").read_text(encoding="utf-8") == "an edit"
    assert set_aside_damaged(recorded.root, "later") == []


def test_a_file_from_the_future_is_of_now(recorded) -> None:
    recorded.merge()
    ahead = recorded.root / "data/fig06.nc"
    os.utime(ahead, (time.time() + 1e6,) * 2)
    assert end_the_future(recorded.root) == [str(ahead)]
    assert ahead.stat().st_mtime <= time.time()
    assert end_the_future(recorded.root) == []


def test_the_history_of_another_owner_is_read(recorded) -> None:
    made = recorded.invocation()
    lock = recorded.root / f"history/{made.name}.lock"
    lock.chmod(0o444)
    assert is_running(recorded.root, made.name)
    made.end("done")
    assert not is_running(recorded.root, made.name)
