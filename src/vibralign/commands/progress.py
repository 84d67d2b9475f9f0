"""Progress of a long command: one line of a terminal, or in a log a line every ten seconds."""

import logging
import shutil
import sys
import time
from typing import cast

from model.runs.engine import PROGRESS

_PAUSE = 10.0  # s, between two lines of a log


class ProgressLine(logging.Handler):
    """A context that shows the step under way and the number of runs done, on standard error."""

    def __init__(self) -> None:
        super().__init__()
        self._terminal, self._step, self._before = sys.stderr.isatty(), "", 0
        self._began = self._told = time.monotonic()

    def begin(self, step: str) -> None:
        """Show a step, in words."""
        self._step, self._before = step, 0
        self._show(step)

    def emit(self, record: logging.LogRecord) -> None:
        """Show how many runs of the step have ended, of those in the batches so far."""
        done, batch = cast("tuple[int, int]", record.args)
        if done == batch:
            self._before += batch
        else:
            self._show(f"{self._step}: {self._before + done:,} of {self._before + batch:,} runs")

    def _show(self, text: str) -> None:
        if self._terminal:
            text = text[: shutil.get_terminal_size().columns - 1]
            print(f"\r{text}", end="\033[K", file=sys.stderr, flush=True)
        elif (now := time.monotonic()) >= self._told + _PAUSE:
            self._told = now
            print(f"{text}, after {now - self._began:.0f} s", file=sys.stderr, flush=True)

    def __enter__(self) -> "ProgressLine":
        PROGRESS.addHandler(self)
        PROGRESS.setLevel(logging.INFO)
        return self

    def __exit__(self, *_: object) -> None:
        """Clear the line of a terminal."""
        PROGRESS.removeHandler(self)
        PROGRESS.setLevel(logging.NOTSET)
        if self._terminal:
            self._show("")
