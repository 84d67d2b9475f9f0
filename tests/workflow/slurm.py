"""A Slurm of two virtual nodes on loopback, with its own configuration, keys and ports."""

import contextlib
import getpass
import os
import platform
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

DAEMONS = ("munged", "slurmctld", "slurmd")
CLIENTS = ("sbatch", "squeue", "srun", "scancel", "scontrol")
NODES = ("n1", "n2")
# Neither accounting nor cgroups: only what Slurm needs to queue, start, limit and cancel jobs.
CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthInfo=socket={munge}
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmctldPort={ports[0]}
StateSaveLocation={here}/state
SlurmdSpoolDir={here}/spool.%n
SlurmctldPidFile={here}/slurmctld.pid
SlurmdPidFile={here}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=bf_interval=2,sched_interval=5
SlurmdParameters=config_overrides
PropagatePrioProcess=1
ReturnToService=2
MinJobAge=86400
KillWait=2
SlurmdTimeout=60
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 RealMemory=8000
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 RealMemory=8000
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""
_PATIENCE = 60.0  # seconds, for a daemon to answer
# An srun of a job step loses SLURM_CONF: the executor keeps few of Slurm's variables.
_SRUN = '#!/bin/sh\nSLURM_CONF="{conf}" exec "{srun}" "$@"\n'


def tool(name: str) -> str | None:
    """Return the path of one of Slurm's programs; daemons are rarely on a user's PATH."""
    return shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/usr/local/sbin")


def missing() -> list[str]:
    """Return which of Slurm's programs are not installed."""
    return [name for name in (*DAEMONS, *CLIENTS) if tool(name) is None]


class Slurm:
    """The running daemons; ``environment`` leads its clients to them."""

    def __init__(self, here: Path) -> None:
        self.here = here
        self.daemons: dict[str, subprocess.Popen[bytes]] = {}
        self.conf = here / "slurm.conf"
        tools = here / "bin"
        tools.mkdir()
        (tools / "srun").write_text(_SRUN.format(conf=self.conf, srun=tool("srun")))
        (tools / "srun").chmod(0o755)
        path = f"{tools}{os.pathsep}{os.environ['PATH']}"
        self.environment = {"SLURM_CONF": str(self.conf), "PATH": path}

    def start(self) -> None:
        """Start munged, slurmctld and both slurmd; return when the nodes are idle."""
        (self.here / "state").mkdir()
        munge, key = self.here / "munge.socket", self.here / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        facts = {
            "host": platform.node().split(".")[0],
            "user": getpass.getuser(),
            "munge": munge,
            "here": self.here,
            "ports": free_ports(3),
        }
        self.conf.write_text(CONFIGURATION.format(**facts), encoding="utf-8")
        own = ("pid-file", "log-file", "seed-file")
        places = [f"--{name}={self.here / f'munge.{name}'}" for name in own]
        self._start("munged", "--foreground", "--force", f"--socket={munge}",
                    f"--key-file={key}", *places)  # fmt: skip
        self._wait(munge.exists, "munged makes its socket")
        self._start("slurmctld", "-D", "-f", str(self.conf))
        for node in NODES:
            self._start("slurmd", "-D", "-f", str(self.conf), "-N", node)
        self._wait(lambda: self.call("sinfo", "-h", "-o", "%T") == "idle", "the nodes are idle")

    def _start(self, name: str, *arguments: str) -> None:
        command = [str(tool(name)), *arguments]
        key = " ".join([name, *(each for each in arguments if each in NODES)])
        with (self.here / f"{key}.out").open("wb") as out:
            self.daemons[key] = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                env={**os.environ, **self.environment},
                start_new_session=True,
            )

    def _wait(self, ready: Callable[[], bool], what: str) -> None:
        until = time.monotonic() + _PATIENCE
        while not ready():
            ended = [key for key, daemon in self.daemons.items() if daemon.poll() is not None]
            if ended or time.monotonic() > until:
                told = {path.name: path.read_text() for path in self.here.glob("*.out")}
                raise RuntimeError(f"waited in vain until {what}; ended: {ended}; {told}")
            time.sleep(0.2)

    def stop(self) -> None:
        """Cancel what is queued, and end the daemons that were started here, by their ids."""
        with contextlib.suppress(RuntimeError):
            self.empty()
        for daemon in reversed(self.daemons.values()):
            daemon.terminate()
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def call(self, *command: str, env: Mapping[str, str] = os.environ) -> str:
        """Run one of Slurm's clients; return what it prints.

        Raises:
            RuntimeError: it fails.
        """
        run = subprocess.run(
            command,
            env={**env, **self.environment},
            capture_output=True,
            text=True,
            check=False,
        )
        if run.returncode:
            raise RuntimeError(f"{' '.join(command)}: {run.stderr}")
        return run.stdout.strip()

    def empty(self) -> None:
        """Cancel every job, and wait until none is left."""
        for number in self.queued():
            self.call("scancel", number)
        self._wait(lambda: not self.queued(), "the queue is empty")

    def limits(self) -> dict[str, str]:
        """Return the time limit of every job that there has been, by its number."""
        lines = self.call("squeue", "-h", "--states=all", "-o", "%i %l").splitlines()
        return dict(line.split() for line in lines)

    def submitted(self) -> int:
        """Return how many jobs there have been."""
        return len(self.limits())

    def queued(self) -> dict[str, str]:
        """Return the state of every job in the queue, by its number."""
        return dict(line.split() for line in self.call("squeue", "-h", "-o", "%i %T").splitlines())


def free_ports(count: int) -> list[int]:
    """Return ports of loopback that nothing listens on."""
    with contextlib.ExitStack() as stack:
        held = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in held:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in held]


@contextlib.contextmanager
def running(here: Path) -> Iterator[Slurm]:
    """Run a Slurm with its files in the folder ``here``, for the time of a test."""
    slurm = Slurm(here)
    try:
        slurm.start()
        yield slurm
    finally:
        slurm.stop()
