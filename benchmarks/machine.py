"""The machine, and times that depend on no peer: start, compilation, gain of a second core."""

import importlib.metadata
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from model.physics.compiled import kernel
from verification.problems import W1


def facts(packages: Sequence[str]) -> dict[str, object]:
    """Processor, Python and the versions of ``packages``; nothing that names the machine."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        "versions": {
            name: version for name in sorted(set(packages)) if (version := _version(name))
        },
    }


def processor() -> str:
    """Name of the processor, from the operating system."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None  # run from its sources, or no Python package


# ----------------------------------------------------------------------------- start, compilation

_RUN_ONE = f"""
from model import Parameters, align
align([{W1!r}], horizon=10.0, cores=1)
"""
_RUN_EVERYTHING = f"""
from model import Parameters, align, simulate
from verification import without_location
case = {W1!r}
align([case], horizon=1.0, cores=1)
simulate(case, horizon=1.0)
without_location.align([case], "rk4", 0.01, horizon=1.0)
"""
_NUMBA_ALONE = "import numba, numpy\n"
# The same equations by the plainest integrator, one sliding mode, no events.
_PLAIN_RK4 = """
import numba, numpy as np
from benchmarks.equations import device
from benchmarks.modes import SLIDE_NEGATIVE, rates, start
from verification.problems import W1

@numba.njit(error_model="numpy")
def rk4(y, p, h, steps):
    k1, k2, k3, k4 = np.empty(6), np.empty(6), np.empty(6), np.empty(6)
    for i in range(steps):
        rates(i * h, y, p, SLIDE_NEGATIVE, k1)
        rates((i + 0.5) * h, y + 0.5 * h * k1, p, SLIDE_NEGATIVE, k2)
        rates((i + 0.5) * h, y + 0.5 * h * k2, p, SLIDE_NEGATIVE, k3)
        rates((i + 1.0) * h, y + h * k3, p, SLIDE_NEGATIVE, k4)
        y += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return y

y, p = start(W1), np.array(device(W1))
from time import process_time
started = process_time()
rk4(y, p, 1e-3, 10)
print(process_time() - started)
"""


def _python(code: str, cache: str | None = None) -> tuple[float, str]:
    """(CPU seconds, output) of a fresh Python that runs ``code``, its modules compiled before."""
    environment = dict(os.environ)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    if cache is not None:
        environment["VIBRALIGN_CACHE"] = cache
    before = os.times()
    run = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, env=environment
    )
    after = os.times()
    spent = after.children_user - before.children_user
    spent += after.children_system - before.children_system
    return spent, run.stdout


def warm_start(repeats: int) -> dict[str, float]:
    """A start with everything compiled, one trajectory included, against numba and numpy alone."""
    _python(_RUN_ONE)
    warm, bare = [], []
    for _ in range(repeats):
        warm.append(_python(_RUN_ONE)[0])
        bare.append(_python(_NUMBA_ALONE)[0])
    started, alone = statistics.median(warm), statistics.median(bare)
    return {"start_s": started, "start_numba_numpy_s": alone, "start_ratio": started / alone}


def compilation() -> dict[str, float]:
    """Compiling from an empty cache against a plain RK4 of the same equations.

    ``compile_s`` for ``align``, ``compile_everything_s`` for all that the study runs: single
    trajectories, and the integrators without event location as well.
    """
    one, everything = map(_compiling, (_RUN_ONE, _RUN_EVERYTHING))
    rk4 = float(_python(_PLAIN_RK4)[1])
    return {
        "compile_s": one,
        "compile_everything_s": everything,
        "compile_rk4_s": rk4,
        "compile_ratio": one / rk4,
        "compile_everything_ratio": everything / rk4,
    }


def _compiling(code: str) -> float:
    """CPU seconds that ``code`` takes longer from an empty cache than from a full one."""
    with tempfile.TemporaryDirectory() as empty:
        cold, _ = _python(code, empty)
        return cold - _python(code, empty)[0]


# ------------------------------------------------------------------------------------------- cores


@kernel
def _multiply_add(values, rounds):
    for _ in range(rounds):
        for j in range(values.size):
            for _ in range(32):
                values[j] = values[j] * 0.999 + 0.001


_ON_CORES = """
import os
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter
try:
    os.sched_setaffinity(0, range(os.cpu_count()))
except (AttributeError, OSError):
    pass
import numpy as np
from benchmarks.machine import multiply_add_for_a_while
from model import align
from model.study.config import load_study, study_path
from model.study.sweeps import sweep_of

sweep = sweep_of(load_study(study_path()), "fig13")
points = np.random.default_rng(20070401).permutation(int(np.prod(sweep.shape)))[:count]
batch = sweep.batch(points)
align(batch, cores=1, horizon=1.0)


def on(cores):
    align(batch, cores=cores, horizon=100.0)


def bare_on(cores):
    with ThreadPoolExecutor(cores) as threads:
        list(threads.map(multiply_add_for_a_while, range(2)))


multiply_add_for_a_while(0)
ratios = []
for _ in range(rounds):
    times = []
    for run in (on, bare_on):
        for cores in (1, 2):
            started = perf_counter()
            run(cores)
            times.append(perf_counter() - started)
    ratios.append((times[0] / times[1], times[2] / times[3]))
print(*np.median(ratios, axis=0))
"""


def multiply_add_for_a_while(_: int) -> None:
    """About a second of arithmetic in the nearest cache, to see what a second core adds at all."""
    _multiply_add(np.ones(512), 1_000_000)


def two_cores(count: int, rounds: int) -> dict[str, float]:
    """Return the speed of two cores over one, by the clock, of ``align`` on Fig. 13, and bare.

    The bare ratio is that of arithmetic without any memory: what the machine gives at most.
    """
    code = f"count, rounds = {count}, {rounds}" + _ON_CORES
    ratio, bare = map(float, _python(code)[1].split())
    return {"two_cores_ratio": ratio, "two_cores_bare_ratio": bare}
