"""Progress of a long command, on one line of a terminal."""

import logging
import shutil
import sys

from model.runs.engines import PROGRESS


class ProgressLine(logging.Handler):
    """A context that shows the step under way and the number of runs done, on one line.

    It shows nothing where standard error is no terminal.
    """

    def __init__(self) -> None:
        super().__init__()
        self._shown, self._step = sys.stderr.isatty(), ""

    def begin(self, step: str) -> None:
        """Show a step, in words."""
        self._step = step
        self._show(step)

    def emit(self, record: logging.LogRecord) -> None:
        """Show how many runs are done, as the engines say it."""
        self._show(f"{self._step}: {record.getMessage()}")

    def _show(self, text: str) -> None:
        if self._shown:
            text = text[: shutil.get_terminal_size().columns - 1]
            print(f"\r{text}", end="\033[K", file=sys.stderr, flush=True)

    def __enter__(self) -> "ProgressLine":
        if self._shown:
            PROGRESS.addHandler(self)
            PROGRESS.setLevel(logging.INFO)
        return self

    def __exit__(self, *_: object) -> None:
        """Clear the line."""
        PROGRESS.removeHandler(self)
        PROGRESS.setLevel(logging.NOTSET)
        self._show("")
