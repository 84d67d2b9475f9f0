"""``python -m study runs``, ``show`` and ``diff``: readable in a terminal, complete in JSON."""

import json
import shutil
from pathlib import Path

import pytest

from study import __main__ as cli
from study.tracking.invocation import Invocation


@pytest.fixture
def root(recorded) -> str:
    """Two invocations: one of them left a failure and another result."""
    recorded.built()
    with recorded.invoked("failed"):
        recorded.merge(0.5, parameters={"press_force": 4.0})
        recorded.fail("plot/fig06", "Traceback …\nValueError: no such colour\n")
    return str(recorded.root)


def output(capsys, *arguments: str, code: int = cli.DONE) -> str:
    assert cli.main(list(arguments)) == code
    printed = capsys.readouterr()
    assert printed.err == ""
    return printed.out


def test_runs_are_listed_with_what_became_of_them(capsys, root) -> None:
    lines = output(capsys, "runs", "--root", root).splitlines()
    assert lines[0].split()[:3] == ["started", "run", "status"]
    assert lines[-1] == "3 runs"
    assert [line.split()[1:3] for line in lines[1:-1]] == [
        ["merge/fig06", "done"],
        ["merge/fig06", "done"],
        ["plot/fig06", "failed"],
    ]
    assert lines[1].endswith("replaced since")
    assert lines[3].endswith("ValueError: no such colour")


def test_runs_and_invocations_are_filtered_and_listed(capsys, root) -> None:
    def found(name: str, *conditions: str) -> list[str]:
        printed = output(capsys, "runs", "--root", root, "--json", *conditions)
        return [each[name] for each in json.loads(printed)]

    assert found("run", "--figure", "6", "--outcome", "failed") == ["plot/fig06"]
    assert found("run", "--outcome", "settled") == ["merge/fig06"] * 2
    assert found("run", "--figure", "fig07") == []
    assert found("outcome", "--invocations") == ["done", "failed"]
    assert found("outcome", "--invocations", "--outcome", "failed") == ["failed"]
    lines = output(capsys, "runs", "--root", root, "--invocations").splitlines()
    assert [line.split()[1] for line in lines[1:]] == ["done", "failed"]


def test_an_invocation_that_was_refused_is_listed_and_shown_with_the_reason(
    capsys, recorded
) -> None:
    reason = "the configuration breaks a rule: config: friction = -0.1: must be >= 0"
    Invocation(recorded.root).record_idle("failed", reason)
    root = str(recorded.root)
    assert reason in output(capsys, "runs", "--root", root, "--invocations").splitlines()[1]
    shown = output(capsys, "show", "--root", root, "last")
    assert f"reason        {reason}" in shown
    assert "0 runs done" in shown
    assert json.loads(output(capsys, "show", "--root", root, "last", "--json"))["reason"] == reason


def test_a_run_is_shown(capsys, root) -> None:
    printed = output(capsys, "show", "--root", root, "merge/fig06")
    assert "press_force  4" in printed
    assert "varied:\n  tilt_stiffness  5, 7\n  press_force     1 to 2, 2 values" in printed
    record = json.loads(output(capsys, "show", "--root", root, "merge/fig06", "--json"))
    assert record["parameters"] == {"press_force": 4.0}
    failed = output(capsys, "show", "--root", root, "plot/fig06")
    assert "reason      ValueError: no such colour" in failed


def test_an_invocation_is_shown_with_its_failures(capsys, root) -> None:
    printed = output(capsys, "show", "--root", root, "last")
    assert "plot/fig06 failed: ValueError: no such colour" in printed
    assert "logs/plot/fig06.log" in printed
    assert "1 runs done" in printed
    assert json.loads(output(capsys, "show", "--root", root, "last", "--json"))["failures"]


def test_a_difference_is_shown_and_is_the_exit_code(capsys, root, recorded, tmp_path) -> None:
    first = str(shutil.copytree(root, tmp_path / "first"))
    same = output(capsys, "diff", root, first)
    assert "data: the same" in same
    assert "not compared" not in same
    recorded.merge(1.0)
    printed = output(capsys, "diff", first, root, code=cli.FAILED)
    assert "metrics: the same" in printed
    row = next(line for line in printed.splitlines() if "tau_align" in line)
    assert row.split() == ["fig06", "tau_align", "4", "1", "0.5", "tilt_stiffness", "=", "7,",
                           "press_force", "=", "1", "3.5", "4"]  # fmt: skip
    found = json.loads(output(capsys, "diff", first, root, "--json", code=1))
    assert found["data"][0]["at"] == {"tilt_stiffness": 7.0, "press_force": 1.0}
    assert found["claims"] is None


def test_a_long_section_is_cut_unless_asked_for(capsys, root, recorded, tmp_path: Path) -> None:
    old = shutil.copytree(root, tmp_path / "old")
    recorded.merge(0.5, parameters={f"name_{i:02}": float(i) for i in range(30)})
    short = output(capsys, "diff", str(old), root, code=1)
    assert "… and 19 more: --all shows them" in short
    assert "name_29" in output(capsys, "diff", str(old), root, "--all", code=1)


def test_what_is_not_recorded_is_refused(capsys, root, tmp_path: Path) -> None:
    for line, words in (
        (["show", "--root", root, "merge/x"], "neither a run nor an invocation"),
        (["diff", str(tmp_path), root], "neither datasets nor sidecars"),
    ):
        assert cli.main(line) == cli.REFUSED
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert words in err
