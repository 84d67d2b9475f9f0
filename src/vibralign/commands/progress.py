"""Progress of a long command: one line of a terminal, or in a log a line every ten seconds."""

import logging
import shutil
import sys
import time
from typing import cast

from model.runs.engine import PROGRESS

_PAUSE = 10.0  # s, between two lines of a log
_LONG = 0.5  # min, from which on a step is announced


class ProgressLine(logging.Handler):
    """A context that shows the step under way and the number of runs done, on standard error."""

    def __init__(self) -> None:
        super().__init__()
        self._terminal, self._step, self._before = sys.stderr.isatty(), "", 0
        self._began = self._told = time.monotonic()
        self._step_began, self._rate, self._forecast = time.perf_counter(), 0.0, False

    def begin(self, step: str) -> None:
        """Show a step, in words."""
        self._rate = self._runs_a_second()
        self._step, self._before, self._forecast = step, 0, False
        self._step_began = time.perf_counter()
        self._show(step)

    def forecast(self, runs: int, words: str) -> None:
        """Say once in a step how long these runs take, if that is half a minute or longer.

        The rate is that of the runs of this step, or of the step before if it has none yet.
        """
        minutes = runs / max(self._runs_a_second(), 1e-3) / 60.0
        if minutes >= _LONG and not self._forecast:
            self._forecast = True
            clear = "\r\033[K" if self._terminal else ""
            said = f"vibralign: up to {minutes:.2g} min for {runs:,} runs {words}"
            print(f"{clear}{said}", file=sys.stderr, flush=True)

    def _runs_a_second(self) -> float:
        taken = time.perf_counter() - self._step_began
        return self._before / max(taken, 1e-3) if self._before else self._rate

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
