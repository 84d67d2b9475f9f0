"""Octave's ode45 with events, as the paper's tool would be used; only where Octave is installed."""

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from benchmarks.equations import device
from benchmarks.methods.base import Method, NotReachedError, Solution, cpu_seconds, longest_step
from benchmarks.modes import first_mode, start
from benchmarks.problems import Problem
from model import Parameters

_SCRIPT = Path(__file__).with_name("octave_ode45.m")
_OCTAVE = shutil.which("octave-cli") or shutil.which("octave")
if _OCTAVE is None:
    raise ImportError("no octave on the PATH")


class OctaveOde45(Method):
    """ode45 in the interpreter; the time is what Octave itself counts, without its start."""

    name = "Octave ode45"
    package = "octave"
    formulation = "interpreted, events, restart at each switch"
    ladder_step = 2

    def warm(self, problem: Problem, tolerance: float) -> None:
        """Nothing to compile."""

    def solve(
        self, problem: Problem, cases: Sequence[Parameters], tolerance: float, deadline: float
    ) -> Solution:
        """As ``Method.solve``."""
        rows = []
        for case in cases:
            p, y = np.array(device(case)), start(case)
            rows.append([*p, *y, first_mode(0.0, y, p), longest_step(case)])
        seconds = min(max(deadline - cpu_seconds(), 0.1), 3600.0)
        stops = [str(stop) for stop in problem.checkpoints or (problem.horizon,)]
        with tempfile.TemporaryDirectory() as folder:
            given, found = Path(folder) / "cases.txt", Path(folder) / "answers.txt"
            np.savetxt(given, rows, fmt="%.17g")
            command = [str(_OCTAVE), "--norc", "--quiet", str(_SCRIPT), str(given), str(found)]
            command += [repr(tolerance), str(seconds), *stops]
            run = subprocess.run(command, capture_output=True, text=True, check=False)
            if run.returncode != 0:
                raise NotReachedError(
                    "out of time" if "out of time" in run.stderr else run.stderr.strip()[:200]
                )
            table = np.loadtxt(found, delimiter=",", ndmin=2)
        return Solution(table[:, 1:], None, seconds=float(table[0, 0]))
