"""The machine and what does not depend on a peer: peak, operations, start, compilation, cores."""

import importlib.metadata
import os
import platform
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import process_time

import numba
import numpy as np

from benchmarks.equations import device
from benchmarks.modes import SLIDE_NEGATIVE, STATE_SIZE, rates, start
from benchmarks.problems import W1, neighbours
from model import Batch, Outcome, Settings, align
from model.engines.batch.series import FREE, SLIDES, STATES
from model.engines.batch.series_code import ORDER, operations
from model.physics.compiled import kernel
from model.runs.align import run_once
from model.study.config import load_study, study_path
from model.study.sweeps import sweep_of

_SEED = 20070401


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
    """The processor's name, as the system tells it."""
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


# ------------------------------------------------------------------------------------------- peak

_CHAINS = 4  # written out in the kernel; the compiler keeps several vectors of each at a time
_STEPS = 32


@kernel  # with vectors as wide as those of the package's kernels
def _multiply_add(values, factor, summand, rounds):
    count = values.shape[1]
    for _ in range(rounds):
        for j in range(count):
            a, b, c, d = values[0, j], values[1, j], values[2, j], values[3, j]
            for _ in range(_STEPS):
                a = a * factor + summand
                b = b * factor + summand
                c = c * factor + summand
                d = d * factor + summand
            values[0, j], values[1, j], values[2, j], values[3, j] = a, b, c, d


def peak_gflops(rounds: int = 5) -> float:
    """Highest rate of double-precision operations seen on one core, in 10⁹ a second.

    Independent chains of fused multiply-adds on numbers that stay in the nearest cache.
    """
    values = np.ones((_CHAINS, 128))
    _multiply_add(values, 0.999, 0.001, 10)
    best, repeats = 0.0, 20_000
    for _ in range(rounds):
        started = process_time()
        _multiply_add(values, 0.999, 0.001, repeats)
        spent = process_time() - started
        best = max(best, 2.0 * _STEPS * values.size * repeats / spent / 1e9)
    return best


@numba.njit(error_model="numpy")
def _bare_loop(y, p, out, count):
    for i in range(count):
        rates(1e-6 * i, y, p, SLIDE_NEGATIVE, out)
        y[2] += 1e-12 * out[2]


def bare_evaluation_ns() -> float:
    """Nanoseconds of a sliding right-hand side in a plain compiled loop, one at a time."""
    y, p, out = start(W1), np.array(device(W1)), np.empty(STATE_SIZE)
    _bare_loop(y, p, out, 10)
    count, times = 100_000, []
    for _ in range(5):
        started = process_time()
        _bare_loop(y, p, out, count)
        times.append(1e9 * (process_time() - started) / count)
    return statistics.median(times)


# ------------------------------------------------------------------------------------- operations


def lane_operations(count: int) -> dict[str, float]:
    """Useful operations a second in the lanes on neighbours of W1, and how many steps are cut.

    Useful are the series of a part that slides and their sums at the ends of steps; not the samples
    and bounds that tell where a switch may be, nor the search for it.
    """
    batch = Batch.stack(neighbours([W1], count))
    settings = Settings(horizon=10.0)
    run_once(batch, settings)
    spent = []
    for _ in range(5):
        started = process_time()
        runs = run_once(batch, settings)
        spent.append(process_time() - started)
    steps, switches = float(runs["steps"].sum()), float(runs["events"].sum())
    useful = steps * (operations(SLIDES, FREE) + 2 * len(STATES) * ORDER)
    return {
        "useful_gflops": useful / statistics.median(spent) / 1e9,
        "switches_a_step": switches / steps,
    }


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
# The same equations by the plainest integrator, one sliding mode, no switches.
_PLAIN_RK4 = """
import numba, numpy as np
from benchmarks.equations import device
from benchmarks.modes import SLIDE_NEGATIVE, rates, start
from benchmarks.problems import W1

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
    trajectories, and the integrators without located switches as well.
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


# ---------------------------------------------------------------------------------- cores, settling

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
    _multiply_add(np.ones((_CHAINS, 128)), 0.999, 0.001, 1_000_000)


def two_cores(count: int, rounds: int) -> dict[str, float]:
    """How much faster two cores are, by the clock: ``align`` on points of Fig. 13's map, and bare.

    The bare ratio is that of arithmetic without any memory: what the machine gives at most.
    """
    code = f"count, rounds = {count}, {rounds}" + _ON_CORES
    ratio, bare = map(float, _python(code)[1].split())
    return {"two_cores_ratio": ratio, "two_cores_bare_ratio": bare}


def settling_gain(count: int, horizons: Sequence[float]) -> dict[str, float]:
    """How much faster maps are if settled runs may stop, on ``count`` points of Figs. 13 and 14.

    ``settling_evaluations`` is the same for the evaluations of what does not align, and
    ``settling_bound`` what the evaluations of the whole map would gain if runs that neither align
    nor leave the scene took none at all; ``aperiodic_share`` are the points that run to the longest
    horizon without settling.
    """
    study = load_study(study_path())
    gains: dict[str, float] = {}
    batches: list[Batch] = []
    for figure in ("fig13", "fig14"):
        sweep = sweep_of(study, figure)
        every = np.random.default_rng(_SEED).permutation(int(np.prod(sweep.shape)))
        batches.append(sweep.batch(every[: count // 2]))
        align(batches[-1], horizon=1.0, cores=1)
    for horizon in horizons:
        spent, outcomes, evaluations = {}, {}, {}
        for may_settle in (True, False):
            started = process_time()
            runs = [
                align(batch, horizon=horizon, may_settle=may_settle, cores=1) for batch in batches
            ]
            spent[may_settle] = process_time() - started
            outcomes[may_settle] = np.concatenate([run.outcome for run in runs])
            evaluations[may_settle] = np.concatenate([run.rhs_evaluations for run in runs])
        never = {each: evaluations[each][outcomes[each] != Outcome.ALIGNED].sum() for each in spent}
        stays = outcomes[False] == Outcome.HORIZON_REACHED
        bound = evaluations[False].sum() / evaluations[False][~stays].sum()
        gains[f"settling_gain_{horizon:g}"] = spent[False] / spent[True]
        gains[f"settling_evaluations_{horizon:g}"] = float(never[False] / never[True])
        gains[f"settling_bound_{horizon:g}"] = float(bound)
        gains["settled_share"] = float(np.mean(outcomes[True] == Outcome.SETTLED))
        gains["aperiodic_share"] = float(np.mean(outcomes[True] == Outcome.HORIZON_REACHED))
    return gains
