"""Progress of long commands: a line on a terminal, nothing elsewhere."""

import logging
import sys
import time

import numpy as np

from model.cli import main as cli
from model.cli.progress import ProgressLine
from model.engines.queue import Queue
from model.runs import engines

COMMAND = ["assess", "--horizon", "3", "--tolerance", "1e-4"]


def wait_a_moment(_rows: object, _tolerances: object, queue: Queue, _results: object) -> None:
    """A kernel that takes 300 of 400 runs, and longer than ``engines._PAUSE``."""
    queue[0] = 300
    time.sleep(20.0 * engines._PAUSE)


def test_steps_and_runs_replace_each_other_on_one_line_of_a_terminal(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr(engines, "_PAUSE", 0.01)
    monkeypatch.setenv("COLUMNS", "40")
    with ProgressLine() as line:
        line.begin("leeways")
        engines._on_cores(wait_a_moment, 1)(np.empty((400, 2)), np.empty(400))
        line.begin("a step whose name is wider than this terminal")
    err = capsys.readouterr().err
    shown = [each.removesuffix("\033[K") for each in err.split("\r")[1:]]
    assert shown[0] == "leeways"
    assert set(shown[1:-2]) == {"leeways: 300 of 400 runs"}
    assert shown[-2:] == ["a step whose name is wider than this te", ""]  # cleared at the end
    assert not engines.PROGRESS.isEnabledFor(logging.INFO)


def test_a_command_says_its_steps_to_a_terminal_only(capsys, monkeypatch):
    assert cli.main(COMMAND) == cli.DONE
    plain = capsys.readouterr()
    assert plain.err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert cli.main(COMMAND) == cli.DONE
    shown = capsys.readouterr()
    assert shown.out == plain.out
    assert "\rstarts, bases and leeways\033[K" in shown.err
    assert shown.err.endswith("\r\033[K")
