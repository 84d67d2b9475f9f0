"""The golden build: a small study, built once a test run by the real Snakemake.

Tests of commands, pages and restarts work on it, or on a copy that they may change.
"""

import atexit
import contextlib
import copy
import fcntl
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from study.config import load_study, study_path

PROJECT = Path(__file__).resolve().parents[1]
PARTS = ("Snakefile", "Makefile", "workflow", "config", "profiles", "requirements.lock")
FIGURES = load_study(study_path())
TINY: dict[str, Any] = {
    "results_root": "tiny",
    "figures": {
        **{name: {"swept": {"count": 4}, "chunks": 1} for name in FIGURES.named("curves")},
        **{
            name: {"x": {"count": 4}, "y": {"count": 3}, "chunks": 1}
            for name in FIGURES.named("map")
        },
        "fig13": {"x": {"count": 4}, "y": {"count": 3}, "chunks": 3},
    },
    "maps": {
        "ensemble": {"phases": 2, "tilts": [1.0], "every": 2},
        "planes": {
            name: {"x": {"count": 3}, "y": {"count": 3}, "chunks": 1}
            for name in (
                "fig13_round",
                "press_force_frequency",
                "friction_press_force",
                "clearance_misalignment",
                "stiffnesses",
            )
        },
    },
    "accuracy": {
        "horizon": 30.0,
        "sets": 4,
        "chunks": 2,
        "fuzz": {"sets": 5, "sets_a_job": 2},
        "settled": {"sets": 4, "chunks": 1, "longer": 2.0},
    },
    "precision": {
        "ladder": {
            "tolerances": [1e-3, 1e-6],
            "max_evaluations": 20_000,
        },
        "cases": {"never_aligning": {"until": 3.0}},
        "hard": {
            "ladder": {
                "tolerances": [1e-3],
                "max_evaluations": 2_000,
            },
            "base": {"stiffness": [1e2, 1e4], "damping": [1.0], "until": 0.1},
            "cases": {
                name: {"until": 0.1, "max_evaluations": 2_000}
                for name in (
                    "many_lift_offs",
                    "long_horizon",
                    "contact_resonance",
                    "much_friction",
                    "no_tilt_spring",
                    "hard_tilt_spring",
                    "at_the_edge",
                )
            },
        },
    },
    "evidence": {"near": 1, "assumptions": []},
    "jamming": {"tilt_stiffness": {"count": 2}, "friction": {"count": 2}},
}
STUDY = ["--configfile", "config/tiny.yaml"]

# What the test on the bytes of a whole study builds: "tiny", "smoke" or "full".
BUILT_TWICE = os.environ.get("VIBRALIGN_STUDY", "tiny")
PATIENCE = 86_400 if BUILT_TWICE == "full" else 3_600  # seconds: a hanging Snakemake fails the test

# Runs Snakemake and the scripts of its jobs as forks of one process, which has loaded what they
# import: most of their time. A fork with another PYTHONPATH or folder of caches imports the project
# anew.
PRELOADED = """
import atexit, gc, json, os, runpy, select, signal, socket, sys
import fontTools.subset, matplotlib.pyplot, netCDF4, pint, scipy.ndimage, scipy.special, smart_open
import matplotlib.backends.backend_agg, matplotlib.backends.backend_pdf
import matplotlib.backends.backend_svg, xarray
import snakemake.cli, snakemake.report.html_reporter
import study.claims, study.config, study.explorer, study.plans, study.plots, study.report.page
import study.schematics, verification.bench.work_precision, vibralign
from model.engine.lane_events import lane_events_of
from model.events.kernels import in_kernels

for scene in vibralign.ALIGNMENT, vibralign.INSERTION:
    lane_events_of(in_kernels(scene).events)  # derived once

OWN = "model", "vibralign", "study", "verification"
READ_AT_IMPORT = "PYTHONPATH", "XDG_CACHE_HOME"
sys.executable = os.path.abspath("python")  # with which Snakemake runs scripts
gc.freeze()  # forks need not look through what they share
listener = socket.socket(socket.AF_UNIX)
listener.bind("socket")
listener.listen()
print("listens", flush=True)

def reap(*_):  # instead of ignoring the signal, so that the forks' time counts as the tests'
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        pass

signal.signal(signal.SIGCHLD, reap)
while sys.stdin not in select.select([listener, sys.stdin], [], [])[0]:  # closed with the tests
    asked, _ = listener.accept()
    if os.fork():
        asked.close()
        continue
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    atexit._clear()  # what the process that forks would do at its own end
    told, written, *_ = socket.recv_fds(asked, 65536, 2)
    while part := asked.recv(65536):
        told += part
    folder, environment, (name, *arguments) = json.loads(told)
    os.dup2(written[0], 1), os.dup2(written[1], 2)
    os.chdir(folder)
    sys.modules.pop("study.tracking.records", None)  # it knows the script that imports it
    if any(environment.get(each) != os.environ.get(each) for each in READ_AT_IMPORT):
        sys.path[:0] = environment["PYTHONPATH"].split(os.pathsep)
        for each in [each for each in sys.modules if each.split(".")[0] in OWN]:
            del sys.modules[each]
    os.environ.clear(), os.environ.update(environment)
    code = 1
    try:
        if name == "-m":
            sys.argv = arguments
            runpy.run_module(arguments[0], run_name="__main__", alter_sys=True)
        else:
            sys.argv = [name, *arguments]
            runpy.run_path(name, run_name="__main__")
        code = 0
    except SystemExit as ended:
        code = ended.code or 0
    except BaseException:  # as the interpreter does with an uncaught exception
        sys.excepthook(*sys.exc_info())
    atexit._run_exitfuncs()
    sys.stdout.flush(), sys.stderr.flush()
    asked.sendall(str(code).encode())
    os._exit(0)
"""
# Stands in for `python`: has PRELOADED run a module or a script, and ends with its exit code. A
# command (-c) runs in a Python of its own, which it was given because of what is read at the start.
CLIENT = """#!{python} -IS
import json, os, socket, sys
if sys.argv[1] == "-c":
    os.execv({python!r}, [{python!r}, *sys.argv[1:]])
server = socket.socket(socket.AF_UNIX)
server.connect({path!r})
asked = json.dumps([os.getcwd(), dict(os.environ), sys.argv[1:]]).encode()
server.sendall(asked[socket.send_fds(server, [asked], [1, 2]):])
server.shutdown(socket.SHUT_WR)
code = b""
while part := server.recv(8):
    code += part
sys.exit(int(code or 1))
"""


def sources_of(checkout: Path) -> str:
    """Return the PYTHONPATH by which a checkout is imported."""
    return f"{checkout / 'src'}{os.pathsep}{checkout}"


class Workspace:
    """A copy of the workflow with the tiny study; the package is the project's own."""

    # One figure of every kind: what most tests build.
    DATA = (
        "tiny/data/fig05.nc",
        "tiny/data/fig11.nc",
        "tiny/data/fig13.nc",
    )
    BESIDE = ("tiny/data/precision.csv",)
    PICTURES = tuple(f"tiny/figures/fig11.{kind}" for kind in ("png", "svg", "pdf"))

    def __init__(self, folder: Path, profile: str = "default", **added: str) -> None:
        self.folder = folder
        self.profile = profile
        self.added = added  # to the environment of every command
        self.checkout = PROJECT
        if (folder / "Snakefile").exists():  # that of another process
            return
        folder.mkdir(exist_ok=True)
        for part in PARTS:
            put = shutil.copytree if (PROJECT / part).is_dir() else shutil.copy
            put(PROJECT / part, folder / part)
        self.configure(TINY)
        self._make_environment()

    def configure(self, study: dict[str, Any]) -> None:
        """Write the configuration whose values replace those of config.yaml."""
        text = yaml.safe_dump(study)
        (self.folder / "config" / "tiny.yaml").write_text(text, encoding="utf-8")

    def _make_environment(self) -> None:
        """Make a stand-in for .venv with CLIENT, or on a cluster this Python, and the package."""
        tools = self.folder / ".venv" / "bin"
        tools.mkdir(parents=True)
        python = sys.executable if self.profile == "slurm" else preloaded()
        run = f'PYTHONPATH="{self.sources}" exec "{python}"'
        for name, words in {"python": "", "snakemake": "-m snakemake"}.items():
            tool = tools / name
            tool.write_text(f'#!/bin/sh\n{run} {words} "$@"\n', encoding="utf-8")
            tool.chmod(0o755)

    @property
    def sources(self) -> str:
        """Folder from which the packages and verification are imported."""
        return sources_of(self.checkout)

    @property
    def environment(self) -> dict[str, str]:
        """Variables with which jobs import the package from ``checkout``, without a start."""
        kept = {name: value for name, value in os.environ.items() if "VIBRALIGN_START" not in name}
        return {**kept, "PYTHONPATH": self.sources, **self.added}

    def command(self, *arguments: str, cores: int = 2) -> list[str]:
        """Snakemake for some targets of the tiny study."""
        profile = f"profiles/{self.profile}"
        words = [sys.executable, "-m", "snakemake", f"-c{cores}", "--workflow-profile", profile]
        return [*words, *arguments, *STUDY]

    def _run(self, *words: str, **options: Any) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            words,
            cwd=self.folder,
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
            **options,
        )

    def snakemake(
        self, *arguments: str, cores: int = 2, **options: Any
    ) -> subprocess.CompletedProcess[str]:
        """Run Snakemake to its end, every job in a Python of its own."""
        return self._run(*self.command(*arguments, cores=cores), **options)

    def forked(self, *arguments: str, cores: int = 2) -> subprocess.CompletedProcess[str]:
        """As ``snakemake``, by PRELOADED and in a fraction of the time."""
        return self._run(preloaded(), *self.command(*arguments, cores=cores)[1:])

    def start(self, *arguments: str) -> subprocess.Popen[bytes]:
        """Start Snakemake in a process group of its own."""
        return subprocess.Popen(
            self.command(*arguments),
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def dry_run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """As ``forked``, without doing anything."""
        return self.forked("-n", *arguments)

    def make_command(self, *targets: str) -> list[str]:
        """`make`, the documented command, for some targets of the tiny study."""
        flags = " ".join([*targets, *STUDY])
        made = ["--old-file=environment", f"PYTHON={sys.executable}", f"PROFILE={self.profile}"]
        return ["make", "--no-print-directory", *made, f"SNAKEMAKE_FLAGS={flags}"]

    def make(self, *targets: str) -> subprocess.CompletedProcess[str]:
        """Run `make` to its end."""
        return self._run(*self.make_command(*targets))

    def kill(self, process: subprocess.Popen[bytes]) -> None:
        """Kill (-9) the remaining processes of a group."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait(timeout=60)

    def planned(self) -> set[tuple[str, str]]:
        """Return (rule, output) of all outputs that a dry run would make."""
        run = self.dry_run("--summary")
        assert run.returncode == 0, run.stderr
        rows = [line.split("\t") for line in run.stdout.splitlines() if "\t" in line]
        head = rows[0]
        table = [dict(zip(head, row, strict=False)) for row in rows[1:]]
        assert len(table) > 100, "the summary lists every output"
        return {(row["rule"], row["output_file"]) for row in table if row["plan"] != "no update"}

    def take_times(self, other: "Workspace") -> None:
        """Copy CPU times, which differ between builds, from another build of the whole study."""
        times = "tiny/benchmarks/precision.csv"
        (self.folder / times).write_bytes((other.folder / times).read_bytes())

    def results(self) -> dict[str, str]:
        """Hashes of all datasets, pictures, pages and the claims by their path."""
        root = self.folder / "tiny"
        kinds = {".nc", ".png", ".svg", ".pdf", ".html"}
        found = [
            path.relative_to(self.folder).as_posix()
            for path in sorted(root.rglob("*"))
            if path.suffix in kinds or path == root / "claims.csv"
        ]
        assert len(found) > 60
        return self.sha256(*(file for file in found if "/history/" not in file))

    def sha256(self, *files: str) -> dict[str, str]:
        """Hashes of files by their path."""
        return {
            file: hashlib.sha256((self.folder / file).read_bytes()).hexdigest() for file in files
        }


@cache
def preloaded() -> str:
    """Start PRELOADED, which ends with this process, and return the path of CLIENT."""
    folder = tempfile.mkdtemp()  # pytest's own are too deep for a socket
    client = Path(folder, "python")
    client.write_text(CLIENT.format(python=sys.executable, path=f"{folder}/socket"))
    client.chmod(0o755)
    server = subprocess.Popen(
        [sys.executable, "-c", PRELOADED],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": sources_of(PROJECT)},
        stdin=subprocess.PIPE,  # closed with this process
        stdout=subprocess.PIPE,
    )
    assert server.stdout is not None
    server.stdout.readline()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    atexit.register(server.communicate)
    return str(client)


@pytest.fixture
def tiny() -> dict[str, Any]:
    """The configuration of the tiny study, to be changed at will."""
    return copy.deepcopy(TINY)


@pytest.fixture
def built_twice(tiny: dict[str, Any]) -> dict[str, Any]:
    """The study whose bytes are compared as a whole."""
    if BUILT_TWICE == "tiny":
        return tiny
    study: dict[str, Any] = {}
    if BUILT_TWICE == "smoke":
        study = yaml.safe_load((PROJECT / "config/smoke.yaml").read_text(encoding="utf-8"))
    return {**study, "results_root": tiny["results_root"]}


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path / "project")


@pytest.fixture(scope="session")
def make_workspace() -> type[Workspace]:
    return Workspace


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """The golden build, one for all processes; tests must not change it."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent
    with (shared / "built.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        made = Workspace(shared / "built")
        if not (shared / "complete").exists():
            run = made.forked()
            assert run.returncode == 0, run.stdout + run.stderr
            (shared / "complete").touch()
    return made


@pytest.fixture(scope="session")
def results(built: Workspace) -> Path:
    """The results of the golden build, to be read only."""
    return built.folder / "tiny"


@pytest.fixture
def copy_of_built(tmp_path: Path, built: Workspace) -> Workspace:
    """A copy of the golden build that a test may change."""
    made = Workspace(tmp_path / "project")
    for part in ("tiny", ".snakemake"):
        shutil.copytree(built.folder / part, made.folder / part)
    return made
