"""Progress of long commands: one line of a terminal, and in a log a line every ten seconds."""

import logging
import sys
import time
from pathlib import Path

from model.engine.queue import Queue
from model.engine.scheduling import MOST_RUNS
from model.runs import engine
from vibralign.commands import main as cli
from vibralign.commands import progress
from vibralign.commands.progress import ProgressLine

PEG = str(Path(__file__).parents[2] / "square" / "peg.yaml")
COMMAND = ["assess", "--device", PEG, "--horizon", "30 ms", "--tolerance", "1e-4"]


def wait_a_moment(queue: Queue) -> None:
    """End 30 of 400 runs, while the rest waits or runs, and longer than ``engine._PAUSE``."""
    queue[0] = 30 + min(400, MOST_RUNS)
    time.sleep(20.0 * engine._PAUSE)


def test_steps_and_runs_replace_each_other_on_one_line_of_a_terminal(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(engine, "_PAUSE", 0.01)
    monkeypatch.setenv("COLUMNS", "40")
    with ProgressLine() as line:
        line.begin("leeways")
        for _ in range(2):
            engine.in_threads(wait_a_moment, 400)
        line.begin("a step whose name is wider than this terminal")
    err = capsys.readouterr().err
    shown = [each.removesuffix("\033[K") for each in err.split("\r")[1:]]
    assert shown[0] == "leeways"
    assert set(shown[1:-2]) == {"leeways: 30 of 400 runs", "leeways: 430 of 800 runs"}
    assert shown[-2:] == ["a step whose name is wider than this te", ""]  # cleared at the end
    assert not engine.PROGRESS.isEnabledFor(logging.INFO)


def test_a_log_gets_a_line_every_ten_seconds(capsys, monkeypatch):
    now = iter(float(second) for second in range(100))
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(now))  # a second at every question
    with ProgressLine() as line:
        line.begin("leeways")
        for done in range(22):
            engine.PROGRESS.info("%d of %d runs", done, 22)
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["leeways: 8 of 22 runs, after 10 s", "leeways: 18 of 22 runs, after 20 s"]


def test_a_short_command_says_its_steps_to_a_terminal_only(capsys, monkeypatch):
    assert cli.main(COMMAND) == cli.DONE
    plain = capsys.readouterr()
    assert plain.err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert cli.main(COMMAND) == cli.DONE
    shown = capsys.readouterr()
    assert shown.out == plain.out
    assert "\rstarts, bases and leeways\033[K" in shown.err
    assert shown.err.endswith("\r\033[K")
