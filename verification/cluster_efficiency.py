"""Efficiency of the study as jobs of Slurm, by a simulation of its scheduling: `make efficiency`.

A campaign is many parts that do not depend on each other, such as those of maps, trials and fuzz.
Their times are drawn from those that a build recorded in its sidecars. The cost of a Slurm job
beyond its parts is measured as processor time of starts of Snakemake and of a part's Python; how
Snakemake submits and asks is that of profiles/slurm. The simulation starts jobs in their order on
the first core that is free; a real cluster adds the wait for other people's jobs.
"""

import argparse
import heapq
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import yaml
from matplotlib.figure import Figure
from numpy.typing import NDArray

from model.show import style
from model.study.csv_tables import csv_text
from model.tracking.provenance import write_text
from model.tracking.records import sidecars

Floats = NDArray[np.float64]

CORES = (1, 2, 8, 64, 512)
PARTS_A_JOB = tuple(2**k for k in range(10))
CAMPAIGN = 36_000.0  # seconds of work on one core
_SEED = 2007
_STARTS = 2  # of Snakemake for a job: in the batch script, and under srun
_SUBMISSION = 0.3  # seconds of sbatch, one after another
_LONGEST = 180.0  # seconds between two questions of the executor; 10 more after each in vain
_PROFILE = Path("profiles/slurm/config.yaml")
_RULE = "map_part"
_OUT = Path("docs/efficiency")


class Costs(NamedTuple):
    """Costs beyond the work, in seconds: of a Slurm job, of each part, and between questions."""

    job: float
    part: float
    question: float


def simulated(work: Floats, cores: int, parts: int, costs: Costs, most: int) -> float:
    """Return the wall time of a campaign in seconds.

    Args:
        work: seconds of each part.
        cores: that run jobs.
        parts: of a job, one after another.
        costs: beyond the work.
        most: jobs that Snakemake has in the queue at most.
    """
    sizes = [work[i : i + parts] for i in range(0, work.size, parts)]
    waiting = [float(each.sum()) + costs.job + costs.part * each.size for each in sizes][::-1]
    free = [0.0] * cores  # when each core is free again
    running: list[float] = []  # ends that Snakemake has not seen
    now, interval = 0.0, costs.question
    while waiting or running:
        submitted = now
        while waiting and len(running) < most:
            submitted += _SUBMISSION
            end = max(heapq.heappop(free), submitted) + waiting.pop()
            heapq.heappush(free, end)
            heapq.heappush(running, end)
        now = max(now + interval, submitted)
        seen = 0
        while running and running[0] <= now:
            heapq.heappop(running)
            seen += 1
        interval = costs.question if seen else min(interval + 10.0, _LONGEST)
    return now


def part_times(root: Path) -> Floats:
    """Return the wall times of the maps' parts in seconds, as a build recorded them.

    Raises:
        ValueError: the build has none.
    """
    times = [each["wall_seconds"] for each in sidecars(root).values() if each["rule"] == _RULE]
    if not times:
        raise ValueError(f"{root}: no job of the rule {_RULE!r} is recorded there; build it first")
    return np.array(times)


def _processor_seconds(*command: str) -> float:
    """Return the processor time of a command and of all that it starts."""
    before = os.times()
    subprocess.run(command, capture_output=True, check=True)
    after = os.times()
    return (
        after.children_user + after.children_system - before.children_user - before.children_system
    )


def measured_costs() -> Costs:
    """Measure the starts on this machine; processor time hardly depends on what else runs."""
    snakemake = _processor_seconds(sys.executable, "-m", "snakemake", "-n", "-c1", "fig01")
    python = _processor_seconds(sys.executable, "-c", "import model.study.maps, netCDF4, xarray")
    asked = yaml.safe_load(_PROFILE.read_text(encoding="utf-8"))
    return Costs(_STARTS * snakemake, python, asked["slurm-init-seconds-before-status-checks"])


def efficiencies(times: Floats, costs: Costs) -> list[dict[str, float]]:
    """Return wall time and efficiency for every number of cores and of parts of a job."""
    rng = np.random.default_rng(_SEED)
    work = rng.choice(times, round(CAMPAIGN / float(times.mean())))
    rows = []
    for cores in CORES:
        for parts in PARTS_A_JOB:
            wall = simulated(work, cores, parts, costs, most=2 * cores)
            rows.append({
                "cores": cores, "parts_a_job": parts, "minutes_a_job": parts * times.mean() / 60.0,
                "wall_minutes": wall / 60.0, "efficiency": float(work.sum()) / (cores * wall),
            })  # fmt: skip
    return rows


def _plain(value: float, _: int) -> str:
    """Return a number on a logarithmic axis as it is said."""
    return f"{value:g}"


def drawn(rows: Sequence[dict[str, float]]) -> Figure:
    """Draw efficiency and wall time over the work of a job."""
    with style.context():
        figure = style.new_figure(height=0.5 * style.FIGURE_WIDTH)
        panels = figure.subplots(1, 2)
        for index, cores in enumerate(CORES):
            own = [row for row in rows if row["cores"] == cores]
            x = [row["minutes_a_job"] for row in own]
            for axes, key in zip(panels, ("efficiency", "wall_minutes"), strict=True):
                look = style.curve(index, len(own))
                axes.plot(x, [row[key] for row in own], label=f"{cores}", **look)
        for axes, label in zip(panels, ("efficiency", "wall time (min)"), strict=True):
            axes.set_xscale("log")
            axes.set_xlabel("work of a Slurm job (min)")
            axes.set_ylabel(label)
            axes.xaxis.set_major_formatter(_plain)
        panels[0].set_ylim(0.0, 1.0)
        panels[1].set_yscale("log")
        panels[1].yaxis.set_major_formatter(_plain)
        panels[0].legend(title="cores", loc="center left", bbox_to_anchor=(0.0, 0.44))
    return figure


def main() -> None:
    """Measure, simulate, and write the table and the picture."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--root", type=Path, default=Path("results"), help="of a full build")
    try:
        times = part_times(parser.parse_args().root)
    except ValueError as error:
        parser.error(str(error))
    costs = measured_costs()
    rows = efficiencies(times, costs)
    write_text(csv_text(tuple(rows[0]), rows), _OUT.with_suffix(".csv"))
    with style.context():
        drawn(rows).savefig(_OUT.with_suffix(".png"), dpi=150)
    print(
        f"{times.size} parts of {times.min():.0f} to {times.max():.0f} s; a job costs "
        f"{costs.job:.1f} s, a part {costs.part:.1f} s; asked every {costs.question:g} s at first"
    )


if __name__ == "__main__":
    main()
